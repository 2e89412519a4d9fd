"""What is missing in a picture, in portions for workers."""

import heapq
import itertools
import math
from typing import NamedTuple

from . import _raio

SHORTEST_S = 0.25


class Portion(NamedTuple):
    """Samples `first` to before `end` of the tiles of a shard, which are counted from 0."""

    shard: int
    shards: int
    first: int
    end: int


class Portions:
    """The missing samples of a film, of which the lowest come first.

    Shards are halved until a portion takes the wanted time, by what workers measured. Their number is
    always a power of two, so the tiles of a film that was filled in this way can be told apart by
    such shards, too: a film that was begun needs no other record.

    Args:
        film: the samples so far.
        samples: the number that every pixel needs.
    """

    def __init__(self, film: _raio.Film, samples: int):
        self._tiles = film.tiles()
        self._order = itertools.count()
        self._queue: list[tuple[int, int, Portion]] = []
        self._rates: dict[tuple[int, int], float] = {}  # seconds per sample of a shard
        self._measured_s, self._measured = 0.0, 0  # and the tiles times samples of these seconds
        self._merged_s, self._merged = 0.0, 0  # and the tiles of the parts that were merged in them
        self.all = self._tiles * samples
        self._queued = 0  # tiles times samples
        self._find(film, 0, 1)
        self.left = self._queued  # with those that were taken

    def _find(self, film: _raio.Film, shard: int, shards: int) -> None:
        spans = film.missing(shard, shards)
        if spans is None:
            self._find(film, shard, 2 * shards)
            self._find(film, shard + shards, 2 * shards)
            return
        for first, end in spans:
            self.put_back(Portion(shard, shards, first, end))

    def __bool__(self) -> bool:
        return bool(self._queue)

    def size(self, portion: Portion) -> int:
        """Tiles times samples."""
        return self._tiles_of(portion) * (portion.end - portion.first)

    def _tiles_of(self, portion: Portion) -> int:
        return len(range(portion.shard, self._tiles, portion.shards))

    def put_back(self, portion: Portion) -> None:
        """For another worker."""
        if self._tiles_of(portion) > 0:
            self._queued += self.size(portion)
            heapq.heappush(self._queue, (portion.first, next(self._order), portion))

    def halve(self, portion: Portion) -> bool:
        """Puts back both halves; False if it is a single sample of a tile."""
        shard, shards, first, end = portion
        if self._tiles_of(portion) > 1:
            self.put_back(Portion(shard, 2 * shards, first, end))
            self.put_back(Portion(shard + shards, 2 * shards, first, end))
        elif end - first > 1:
            middle = (first + end) // 2
            self.put_back(Portion(shard, shards, first, middle))
            self.put_back(Portion(shard, shards, middle, end))
        else:
            return False
        return True

    def done(self, portion: Portion, seconds: float, merge_seconds: float = 0) -> None:
        """A worker has rendered it in this time, and the client has merged it in that."""
        self._merged_s += merge_seconds
        self._merged += self._tiles_of(portion)
        self.left -= self.size(portion)
        self._measured_s += seconds
        self._measured += self.size(portion)
        self._rates[portion.shard, portion.shards] = seconds / (portion.end - portion.first)

    def _rate(self, portion: Portion) -> float | None:
        """Seconds per sample: of the shard, or of the smallest around it that was measured."""
        shards = portion.shards
        while shards > 0:
            if (rate := self._rates.get((portion.shard % shards, shards))) is not None:
                return rate * shards / portion.shards
            shards //= 2
        return self._measured_s / self._measured * self._tiles_of(portion) if self._measured else None

    def take(self, cores: int, longest_s: float) -> Portion:
        """The next portion.

        Portions become shorter towards the end, so that all cores finish together. They have enough samples that
        merging takes at most half of the client's time. Until something is measured, they are single samples of
        small shards.
        """
        left_s = self._queued * self._measured_s / self._measured if self._measured else 0.0
        _, _, portion = heapq.heappop(self._queue)
        self._queued -= self.size(portion)
        _, _, first, end = portion
        rate = self._rate(portion)
        if rate is None:
            stop = first + 1
            while portion.shards < 8 * cores and self._tiles_of(portion) > 1:
                portion = self._half(portion)
        else:
            wanted_s = min(max(left_s / (3 * cores), SHORTEST_S), longest_s)
            rate = max(rate, 1e-9)
            per_tile = rate / self._tiles_of(portion)
            merge_s = self._merged_s / max(self._merged, 1)
            least = max(1, math.ceil(2 * cores * merge_s / per_tile))
            # Each pass has three times the samples of all before it: the whole picture is refined.
            stop = min(end, max(4 * first, first + least, first + int(wanted_s / rate)))
            while rate * (stop - first) > 1.5 * wanted_s and self._tiles_of(portion) > 1:
                portion = self._half(portion)
                rate = self._rate(portion) or rate / 2
            if rate * (stop - first) > 1.5 * wanted_s:
                stop = min(end, first + max(least, int(wanted_s / rate)))
        if stop < end:
            self.put_back(portion._replace(first=stop))
        return portion._replace(end=stop)

    def _half(self, portion: Portion) -> Portion:
        """The first half of a shard; the other one is put back."""
        shard, shards, first, end = portion
        self.put_back(Portion(shard + shards, 2 * shards, first, end))
        return Portion(shard, 2 * shards, first, end)
