"""Films, which hold samples, and images, which are finished."""

import importlib.util
import os
import threading
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _raio

if TYPE_CHECKING:
    from ._scene import Scene

Path = str | os.PathLike[str]


def _find_oidn() -> None:
    """Lets the option `denoise` find Open Image Denoise in the package pyoidn."""
    package = importlib.util.find_spec("pyoidn")
    if package is None or package.origin is None or "RAIO_OIDN" in os.environ:
        return
    library = os.path.join(os.path.dirname(package.origin), "oidn", "lib", "libOpenImageDenoise.so.2")
    if os.path.exists(library):
        os.environ["RAIO_OIDN"] = library


_find_oidn()


class Image:
    """A rendered picture with its channels. A notebook shows it."""

    def __init__(self, film: _raio.Film):
        self._film = film

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        width, height = self._film.size()
        return width, height

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of the requested channels; `image["depth"]` is the array of one."""
        return tuple(self._film.channels())

    def numpy(self) -> npt.NDArray[np.float32]:
        """Red, green, blue and opacity, (height, width, 4) float32, premultiplied.

        Light for `ambient`, display values for `classic`; not clamped. Row 0 is the top.
        """
        return self._film.rgba()

    def display(self) -> npt.NDArray[np.uint8]:
        """Red, green, blue and opacity as a screen shows them, (height, width, 4) uint8, straight."""
        return self._film.display()

    def __getitem__(self, channel: str) -> npt.NDArray[Any]:
        """A channel: (height, width) or (height, width, components), float32 or uint32."""
        try:
            values: npt.NDArray[Any] = self._film.channel(channel)  # type: ignore[assignment]
            return values
        except ValueError as error:
            raise KeyError(str(error)) from None

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> npt.NDArray[Any]:
        return np.asarray(self.display(), dtype=dtype)

    def save(self, path: Path) -> None:
        """Writes .png, .ppm, .pfm or .npy, which hold colours (.png and .npy also alpha), .exr or .npz,
        which hold all channels, too, or .raio with all samples. Whole or not at all. Raises OSError,
        and ValueError for other suffixes."""
        self._film.write(os.fspath(path))

    def settings(self) -> dict[str, str]:
        """The options that determine this picture, as the command line writes them."""
        from ._options import table

        core = self._film.settings()
        texts = {keyword: core.get(o["name"]) for keyword, o in table().items()}
        return {keyword: text for keyword, text in texts.items() if text}

    def _repr_png_(self) -> bytes:
        return self._film.encode(".png")

    def __repr__(self) -> str:
        width, height = self.size
        return f"<raio.Image of {width} x {height}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickle_image, (self._film.to_bytes(), self._film.annotations())


class Film:
    """A picture that is rendered bit by bit: it can be refined, stored, resumed and merged.

    By Scene.start() or load_film(). The samples may come in any portions and order, on any machine:
    the result has the bytes of a single render. Several threads may use a film: add() lets one work.
    """

    def __init__(self, film: "_raio.Film | None", scene: "Scene | None" = None,
                 options: dict[str, Any] | None = None):
        self._film = film
        self._scene = scene
        self._options = options or {}
        self._adding = threading.Lock()

    @property
    def samples(self) -> int:
        """The samples that every pixel has."""
        return 0 if self._film is None else int(self._film.samples()[0])

    @property
    def missing(self) -> str:
        """The samples that are missing, in words; empty: none."""
        return "all samples" if self._film is None else self._film.missing()

    def add(self, samples: int = 16, progress: Any = False) -> "Film":
        """Adds samples to every pixel. Raises ValueError for a film without a scene."""
        if self._scene is None:
            raise ValueError("this film has no scene; give it to load_film()")
        if samples < 1:
            raise ValueError(f"samples: expected a whole number from 1 on, found {samples}")
        with self._adding:
            options = dict(self._options, samples=self.samples + samples)
            self._film = self._scene._render(options, progress, begun=self._film)
        return self

    def image(self) -> Image:
        """The picture so far."""
        return Image(self._core("has no samples yet; call add()"))

    def save(self, path: Path) -> None:
        """Writes all samples to a .raio file, which `raio merge` and load_film() read, or a picture."""
        self._core("has no samples yet; call add()").write(os.fspath(path))

    def to_bytes(self) -> bytes:
        """The bytes of a .raio file."""
        return self._core("has no samples yet; call add()").to_bytes()

    def _core(self, why: str) -> "_raio.Film":
        if self._film is None:
            raise ValueError(f"the film {why}")
        return self._film

    def _repr_png_(self) -> bytes | None:
        return None if self._film is None else self._film.encode(".png")

    def __repr__(self) -> str:
        return f"<raio.Film with {self.samples} samples a pixel>"

    def __reduce__(self) -> tuple[Any, ...]:
        data = None if self._film is None else (self._film.to_bytes(), self._film.annotations())
        return _unpickle_film, (data, self._scene, self._options)


def _unpickle_image(data: bytes, annotations: Any) -> Image:
    return Image(_annotated(data, annotations))


def _annotated(data: bytes, annotations: Any) -> _raio.Film:
    film = _raio.Film.from_bytes(data)
    color_bar, _, legend, scale_bar = annotations
    if color_bar or legend or scale_bar:
        film.annotate(annotations)
    return film


def _unpickle_film(data: Any, scene: Any, options: dict[str, Any]) -> Film:
    return Film(None if data is None else _annotated(*data), scene, options)


def load_film(path: Path, scene: "Scene | None" = None, **options: Any) -> Film:
    """Reads a .raio file of samples. With its scene and options, samples can be added; only then are
    annotations drawn, which such a file does not store."""
    return Film(_raio.Film.read(os.fspath(path)), scene, options)


def merge(films: Iterable[Film | Image]) -> Film:
    """Combines the samples of films, in any order, exactly. Raises ValueError if one does not fit."""
    all_films = list(films)
    for film in all_films:
        if not isinstance(film, (Film, Image)):
            raise TypeError(f"films: expected Films and Images, found {film!r}")
    parts = [film._film for film in all_films if film._film is not None]
    if not parts or len(parts) < len(all_films):
        raise ValueError("films: expected at least one, each with samples")
    return Film(_raio.Film.merge(parts))


