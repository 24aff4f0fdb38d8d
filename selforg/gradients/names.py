"""Names and the numbers that stand for them in tables."""


class Codes:
    """Numbers names in the order of their first use, from `first` on; names known from the start are 0, 1, ..."""

    def __init__(self, first: int = 0, known: tuple[str, ...] = ()) -> None:
        self._first = first
        self._codes = {name: code for code, name in enumerate(known)}
        self._names: list[str] = []

    def __len__(self) -> int:
        """Return how many names were used, without those known from the start."""
        return len(self._names)

    def __contains__(self, name: str) -> bool:
        """Return whether a name has a number."""
        return name in self._codes

    def code(self, name: str) -> int:
        """Return the number of `name`, a new one if it was never used."""
        if name not in self._codes:
            self._codes[name] = self._first + len(self._names)
            self._names.append(name)
        return self._codes[name]

    def name(self, code: int) -> str:
        """Return the name with a number from `first` on."""
        return self._names[code - self._first]

    def numbered(self) -> tuple[str, ...]:
        """Return the names that were used, by their numbers from `first` on."""
        return tuple(self._names)

    def names(self) -> list[str]:
        """Return the names that were used, sorted."""
        return sorted(self._names)
