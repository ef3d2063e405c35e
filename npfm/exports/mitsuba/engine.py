"""Mitsuba 3, found and started: which of its variants works on this machine.

Its fast variants compile with LLVM, which is a library of the system. LLVM 15 ends the process
("Cannot select: v16f32") where a BSDF in Python is compiled, 19 does not; others were not tried.
"""

import os
import re
from glob import glob
from types import ModuleType

from npfm.errors import NpfmError

#: The oldest version of LLVM that is taken without being asked for.
LEAST_LLVM = 19
#: The variable by which Dr.Jit, Mitsuba's compiler, is told where LLVM is.
VARIABLE = "DRJIT_LIBLLVM_PATH"
PLACES = (
    "/usr/lib/*/libLLVM*.so*",
    "/usr/lib/llvm-*/lib/libLLVM*.so*",
    "/usr/lib64/libLLVM*.so*",
    "/usr/lib/libLLVM*.so*",
)
#: Fewer threads than these and Dr.Jit waits for itself when a scene is loaded.
THREADS = 2
COMPILED, INTERPRETED = "llvm_ad_rgb", "scalar_rgb"


def start(variant: str | None = None) -> ModuleType:
    """Import Mitsuba and set its variant.

    Parameters
    ----------
    variant : str, optional
        One of Mitsuba's. If nothing is said, the one that is set stays; and if none is set, it is
        `COMPILED` where there is an LLVM for it, else `INTERPRETED`.

    Raises
    ------
    NpfmError
        If Mitsuba is not installed, or has no such variant.
    """
    library = os.environ.get(VARIABLE) or llvm()
    if library:
        # Dr.Jit reads it when it compiles for the first time.
        os.environ[VARIABLE] = library
    mitsuba = _import()
    variant = variant or mitsuba.variant() or (COMPILED if library else INTERPRETED)
    if variant not in mitsuba.variants():
        raise NpfmError(f"Mitsuba has no variant '{variant}'; use {COMPILED} or {INTERPRETED}")
    mitsuba.set_variant(variant)
    if mitsuba.is_spectral or mitsuba.is_polarized:
        raise NpfmError(f"tables have three channels and no wavelengths: not {variant}, but *_rgb")
    if variant.startswith("llvm"):
        import drjit

        drjit.set_thread_count(THREADS)
    return mitsuba


def llvm() -> str | None:
    """Path of the newest LLVM of the system that is known to work, if there is one."""
    found = {_version(path): path for place in PLACES for path in sorted(glob(place))}
    best = max(found, default=0)
    return found[best] if best >= LEAST_LLVM else None


def _version(path: str) -> int:
    """Major version in a name such as libLLVM.so.19.1 or libLLVM-15.so.1."""
    number = re.search(r"libLLVM(?:-|\.so\.)(\d+)", path)
    return int(number[1]) if number else 0


def _import() -> ModuleType:
    try:
        import mitsuba
    except ImportError as error:
        raise NpfmError(
            "light that bounces is rendered by Mitsuba 3, which is not installed; "
            "use pip install 'npfm[mitsuba]'"
        ) from error
    return mitsuba


def advice() -> str | None:
    """Say why Mitsuba is slow, in a line, where it is interpreted for want of an LLVM."""
    if _import().variant() != INTERPRETED or os.environ.get(VARIABLE):
        return None
    return (
        f"there is no LLVM {LEAST_LLVM} or later: Mitsuba runs as {INTERPRETED}, a hundred times "
        f"slower; install one (Debian: libllvm{LEAST_LLVM}), or name it in {VARIABLE}"
    )
