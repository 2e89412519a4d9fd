"""Progress of long work: tqdm where it is installed, else a line on a terminal."""

import sys
from collections.abc import Callable
from types import TracebackType
from typing import Any

# False, True, or a function of the stage ("reading", "building", "rendering") and its share, 0 to 1.
Progress = bool | Callable[[str, float], None]


class Reporter:
    """Passes the progress on. `report` is None if nobody wants it."""

    def __init__(self, progress: Progress):
        if not callable(progress) and progress not in (True, False, None):
            raise TypeError(f"progress: expected True, False or a function, found {progress!r}")
        self._bar: Any = None
        self._stage = ""
        self._tell = progress
        self.report: Callable[[str, float, int], None] | None = self._told if progress else None

    def _told(self, stage: str, share: float, rays: int) -> None:
        if callable(self._tell):
            self._tell(stage, share)
            return
        if self._bar is None:
            self._bar = _bar()
        if stage != self._stage:
            self._stage = stage
            self._bar.set_description(stage)
        self._bar.n = round(share * 100)
        self._bar.refresh()

    def __enter__(self) -> "Reporter":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        if self._bar is not None:
            if kind is None:
                self._bar.n = 100
                self._bar.refresh()
            self._bar.close()


class _Line:
    """A line on a terminal."""

    n = 0

    def __init__(self) -> None:
        self._stage = ""

    def set_description(self, stage: str) -> None:
        self._stage = stage

    def refresh(self) -> None:
        if sys.stderr.isatty():
            print(f"\r{self._stage} {self.n} %", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if sys.stderr.isatty():
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def _bar() -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _Line()
    return tqdm(total=100, leave=False, bar_format="{desc} {percentage:3.0f}%|{bar}| {remaining}")
