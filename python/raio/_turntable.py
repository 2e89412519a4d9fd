"""A camera that the mouse moves, as in the program's window (src/view/camera_control.cpp)."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]

_POLE_MARGIN = 0.01  # least angle between the line of sight and `up`, radians
_HALF_TURN = 400  # least distance of a drag that turns by 180 degrees
_WHEEL_STEP = 0.88  # factor of the remaining distance


def _unit(v: Vector) -> Vector:
    return v / np.linalg.norm(v)


def _rotated(v: Vector, axis: Vector, angle: float) -> Vector:
    c, s = math.cos(angle), math.sin(angle)
    turned: Vector = v * c + np.cross(axis, v) * s + axis * (float(axis @ v) * (1 - c))
    return turned


@dataclass(frozen=True)
class Camera:
    """`fov`: vertical, degrees. `is_parallel`: orthographic."""

    from_: Vector
    at: Vector
    up: Vector
    fov: float
    is_parallel: bool = False

    def options(self) -> dict[str, Any]:
        """As keyword arguments of Scene.camera() and Scene.render()."""
        return {"from_": tuple(map(float, self.from_)), "at": tuple(map(float, self.at)),
                "up": tuple(map(float, self.up)), "fov": float(self.fov),
                "projection": "orthographic" if self.is_parallel else "perspective"}

    def _axes(self) -> tuple[Vector, Vector, Vector]:
        forward = _unit(self.at - self.from_)
        right = _unit(np.cross(forward, self.up))
        return right, np.cross(right, forward), forward

    def _half_height(self, depth: float) -> float:
        if self.is_parallel:
            depth = float(np.linalg.norm(self.at - self.from_))
        return depth * math.tan(math.radians(self.fov) / 2)

    def _depth(self, point: Vector) -> float:
        depth = float((point - self.from_) @ self._axes()[2])
        return depth if depth > 0 else float(np.linalg.norm(self.at - self.from_))

    def turned(self, pivot: Vector, dx: float, dy: float, height: float) -> "Camera":
        """After a drag by (dx, dy) over a picture of this height, in the same unit."""
        angle = math.pi * min(1.0, height / _HALF_TURN) / height
        right, _, forward = self._axes()
        pole = math.acos(min(1.0, max(-1.0, float(forward @ _unit(self.up)))))
        tilt = min(max(-dy * angle, min(0.0, pole - (math.pi - _POLE_MARGIN))),
                   max(0.0, pole - _POLE_MARGIN))

        def turn(point: Vector) -> Vector:
            tilted = _rotated(point - pivot, right, tilt)
            return pivot + _rotated(tilted, _unit(self.up), -dx * angle)

        return replace(self, from_=turn(self.from_), at=turn(self.at))

    def panned(self, pivot: Vector, dx: float, dy: float, height: float) -> "Camera":
        """So that the pivot follows the mouse."""
        right, up, _ = self._axes()
        unit = 2 * self._half_height(self._depth(pivot)) / height
        move = (-dx * right + dy * up) * unit
        return replace(self, from_=self.from_ + move, at=self.at + move)

    def ray(self, x: float, y: float, aspect: float) -> tuple[Vector, Vector]:
        """The start and the direction of sight at x, y: 0 to 1 from the upper left corner."""
        right, up, forward = self._axes()
        depth = float(np.linalg.norm(self.at - self.from_))
        half = self._half_height(depth)
        aside = right * ((2 * x - 1) * half * aspect) + up * ((1 - 2 * y) * half)
        if self.is_parallel:
            return self.from_ + aside, forward * depth
        return self.from_, forward * depth + aside

    def zoomed(self, target: Vector, steps: float) -> "Camera":
        """Nearer to a point, which stays where it is in the picture."""
        factor = _WHEEL_STEP ** steps
        right, up, forward = self._axes()
        move = (target - self.from_) * (1 - factor)
        if self.is_parallel:
            before = math.tan(math.radians(self.fov) / 2)
            fov = min(max(math.degrees(2 * math.atan(before * factor)), 0.001), 170.0)
            factor = math.tan(math.radians(fov) / 2) / before
            aside = (target - self.from_) * (1 - factor)
            move = right * float(aside @ right) + up * float(aside @ up)
            return replace(self, from_=self.from_ + move, at=self.at + move, fov=fov)
        # The point looked at keeps its depth while it is in front.
        distance = float(np.linalg.norm(self.at - self.from_))
        ahead = max(distance - float(move @ forward), 0.05 * distance)
        start = self.from_ + move
        return replace(self, from_=start, at=start + forward * ahead)
