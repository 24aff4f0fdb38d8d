"""Compilation of parts of kernels: each is compiled once, into code that kernels link and optimise with their own.

Numba by itself would optimise every function and turn it into machine code, and do both again within each caller. It
would also compile a function once more for each set of compiler options and for each constant that callers pass. This
module uses features of Numba that are not documented; CLEAN_SWARM_PLAIN_NUMBA=1 does without.
It saves a third of the first start: docs/decisions/0055-parts-of-kernels.md.
"""

from collections.abc import Callable, Mapping
from typing import Any, ParamSpec, TypeVar, cast

import numba
from numba import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler as NumbaCompiler
from numba.core.compiler import Flags
from numba.extending import models, register_model

from selforg.compiler.intrinsics import Compiler

Given = ParamSpec("Given")
Result = TypeVar("Result")

JIT: Compiler = numba.njit
FUNCTION_OBJECT: Compiler = vars(numba)["_dynfunc"].make_function


class PartCode(JITCodeLibrary):
    """The code of a part as it was generated, for kernels to link."""

    def _optimize_final_module(self) -> None:
        """Leave the code as it is; Numba calls this when the code of all callees is linked."""

    def _finalize_final_module(self) -> None:
        """Make no machine code; Numba calls this last."""
        self._finalized = True


class PartOptions(Flags):
    """Options of the compiler, one object for all parts with equal ones.

    Numba looks functions up by options and compares those one by one, at each of 50,000 calls that it types.
    """

    def copy(self) -> Compiler:
        """Return these options, which nothing changes."""
        return self

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)


CODE: Compiler = PartCode
OF_PARTS: Compiler = PartOptions
OPTIONS: dict[Flags, PartOptions] = {}
"""By Numba's own options."""


class PartCompiler(NumbaCompiler):
    """Numba's compiler without the last step, which makes a function callable by itself."""

    def compile_extra(self, func: Callable[..., Any]) -> Compiler:
        """Compile a function; callers know it by a function object without machine code."""
        state, compile_extra = self.state, cast("Compiler", super().compile_extra)
        state.flags.no_compile = True
        state.flags = OPTIONS.setdefault(state.flags, OF_PARTS(state.flags))
        state.library = CODE(state.targetctx.codegen(), func.__qualname__)
        done = compile_extra(func)
        key = FUNCTION_OBJECT(done.fndesc.lookup_module(), func.__name__, "", 0, done.environment, (done.library,))
        state.targetctx.insert_user_function(key, done.fndesc, [done.library])
        return done._replace(entry_point=key)


class PartType(types.Dispatcher):
    """Numba's type of a part: all whole numbers but uint64 are int64, and constants have the type of other values."""

    def get_call_type(self, context: Compiler, args: tuple[Compiler, ...], kws: Mapping[str, Any]) -> Compiler:
        """Return the signature of a call with arguments of types `args`."""
        values: list[Compiler] = list(map(types.unliteral, args))
        whole = [isinstance(one, types.Integer) and one != types.uint64 for one in values]
        plain = tuple(types.int64 if is_whole else one for one, is_whole in zip(values, whole, strict=True))
        return super().get_call_type(context, plain, kws)


register_model(PartType)(models.OpaqueModel)


def known_to_kernels(function: Callable[Given, Result], options: Mapping[str, Any]) -> Callable[Given, Result]:
    """Return `function` itself, with attributes by which compiled callers find its compiled code."""
    named: Any = function
    named.compiled = JIT(**options, no_cpython_wrapper=True, pipeline_class=PartCompiler)(function)
    named._numba_type_ = PartType(named.compiled)
    return function
