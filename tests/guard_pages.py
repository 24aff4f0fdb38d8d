"""NumPy's memory between guard pages, so that an access outside of an array ends the process at once (Linux).

Each array that is made after `guard` lies on pages of its own, with its end at the end of the last one. The pages
before and behind cannot be accessed, and those of an array that is gone neither, for ever. An address that outlives its
array is thus a SIGSEGV, and so is an index behind the end. Not guarded: arrays made before, memory inside compiled
functions and of libraries, and up to seven bytes between an array and the page behind it.

AddressSanitizer would not see what Numba compiles, and Valgrind would interpret the compiler, too.
"""

import ctypes
import mmap

import numpy as np

SPACE = 1 << 40
"""Addresses that are reserved [bytes]; none is used twice."""
PAGE = mmap.PAGESIZE
PROT_NONE, PROT_READ_WRITE, ANONYMOUS_NORESERVE, DONT_NEED = 0, 3, 0x4022, 4
SET_HANDLER = 304
"""Number of PyDataMem_SetHandler in NumPy's table of functions (`numpy_api.py` of NumPy, NEP 49)."""

SIZE, POINTER = ctypes.c_size_t, ctypes.c_void_p
MALLOC = ctypes.CFUNCTYPE(POINTER, POINTER, SIZE)
CALLOC = ctypes.CFUNCTYPE(POINTER, POINTER, SIZE, SIZE)
REALLOC = ctypes.CFUNCTYPE(POINTER, POINTER, POINTER, SIZE)
FREE = ctypes.CFUNCTYPE(None, POINTER, POINTER, SIZE)


class Handler(ctypes.Structure):
    """NumPy's PyDataMem_Handler."""

    _fields_ = (
        ("name", ctypes.c_char * 127),
        ("version", ctypes.c_uint8),
        ("context", POINTER),
        ("malloc", MALLOC),
        ("calloc", CALLOC),
        ("realloc", REALLOC),
        ("free", FREE),
    )


class Pages:
    """Gives memory between guard pages and takes it back."""

    def __init__(self) -> None:
        self._libc = ctypes.CDLL(None, use_errno=True)
        self._libc.mmap.restype = POINTER
        self._libc.mmap.argtypes = (POINTER, SIZE, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long)
        self._libc.mprotect.argtypes = (POINTER, SIZE, ctypes.c_int)
        self._libc.madvise.argtypes = (POINTER, SIZE, ctypes.c_int)
        self._free = self._libc.mmap(None, SPACE, PROT_NONE, ANONYMOUS_NORESERVE, -1, 0) + PAGE
        self._given: dict[int, tuple[int, int]] = {}  # address -> first page and size asked for

    def give(self, _: object, size: int) -> int:
        """Return the address of `size` bytes, all 0."""
        length = max(-(-size // PAGE), 1) * PAGE
        begin, self._free = self._free, self._free + length + PAGE
        if self._libc.mprotect(begin, length, PROT_READ_WRITE):
            return 0  # NumPy raises MemoryError
        address = begin + length - max(-(-size // 8), 1) * 8
        self._given[address] = (begin, size)
        return int(address)

    def give_again(self, _: object, address: int, size: int) -> int:
        """Return the address of `size` bytes that begin with what is at `address`, which is taken back."""
        new = self.give(None, size)
        ctypes.memmove(new, address, min(self._given[address][1], size))
        self.take(None, address, 0)
        return new

    def take(self, _: object, address: int | None, size: int) -> None:
        """Let nobody access what was given at an address."""
        if address is not None:
            begin, size = self._given.pop(address)
            length = max(-(-size // PAGE), 1) * PAGE
            self._libc.madvise(begin, length, DONT_NEED)
            self._libc.mprotect(begin, length, PROT_NONE)


KEPT: list[object] = []
"""What must live as long as arrays do."""


def guard() -> None:
    """Let NumPy put each new array between guard pages, from now on and until the process ends."""
    pages = Pages()
    functions = (
        MALLOC(pages.give),
        CALLOC(lambda context, count, size: pages.give(context, count * size)),
        REALLOC(pages.give_again),
        FREE(pages.take),
    )
    handler = Handler(b"guard pages", 1, None, *functions)
    api, new = ctypes.pythonapi.PyCapsule_GetPointer, ctypes.pythonapi.PyCapsule_New
    api.restype, api.argtypes = POINTER, (ctypes.py_object, ctypes.c_char_p)
    new.restype, new.argtypes = ctypes.py_object, (POINTER, ctypes.c_char_p, POINTER)
    table = ctypes.cast(api(np._core._multiarray_umath._ARRAY_API, None), ctypes.POINTER(POINTER))
    set_handler = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.py_object)(table[SET_HANDLER])
    KEPT.extend((pages, functions, handler, set_handler(new(ctypes.addressof(handler), b"mem_handler", None))))
