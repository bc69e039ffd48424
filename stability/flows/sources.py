"""Flows from files of one's own: how they are imported, told apart by a digest, sent to workers, and blamed."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

from ..errors import ParameterError, StabilityError

_PACKAGE = __name__.partition(".")[0]
_DIGITS = 16  # of a digest that are shown: two versions of a file never share them
_MARK, _SEAL = "__flow_file__", "__flow_digest__"  # of a module that was imported from a file: its path, its digest

_classes: dict[tuple[str, str], None] = {}  # module and name of every class of flows that is none of this package


def load_class(name: str) -> Any:
    """Return what FILE.py:NAME or PACKAGE.MODULE:NAME stands for; ParameterError where there is no such thing."""
    place, _, cls = name.rpartition(":")
    if name.endswith(".py"):
        place, cls = name, ""
    if not place or not cls.isidentifier():
        raise ParameterError(f"{name}: name the class of the flow: {place or name}:Class{_classes_in(place)}")
    if place.endswith(".py"):
        return _member(file_module(place), cls, place)
    return from_module(f"{place}:{cls}", name)


def from_module(target: str, asked: str) -> Any:
    """Return PACKAGE.MODULE:NAME; `asked` says in a message who asked for it."""
    place, _, cls = target.partition(":")
    try:
        module = import_module(place)
    except ModuleNotFoundError as reason:
        if reason.name and (place == reason.name or place.startswith(f"{reason.name}.")):
            raise ParameterError(f"{asked}: there is no module {reason.name}; a file is named path/to/file.py:{cls}") \
                from None
        raise _import_failure(asked, None, reason) from reason
    except (Exception, SystemExit) as reason:
        raise _import_failure(asked, None, reason) from reason
    return _member(module, cls, place)


def file_module(path: str) -> ModuleType:
    """Import a file as a module of its own, once for each version of it; its folder is searched for what it imports."""
    file = Path(path)
    try:
        content = file.read_bytes()
    except OSError as reason:
        raise ParameterError(f"{path}: cannot be read: {reason.strerror}") from None
    name = f"flows_of_{file.stem}_{_digits_of(bytes(file.resolve()) + content)}"
    if name in sys.modules:
        return sys.modules[name]
    spec = spec_from_file_location(name, file)
    assert spec is not None  # as it ends in .py
    module = module_from_spec(spec)
    setattr(module, _MARK, str(file.resolve()))
    sys.modules[name] = module
    folder = str(file.resolve().parent)
    sys.path.insert(0, folder)
    try:
        exec(compile(content, str(file), "exec", dont_inherit=True), module.__dict__)
    except (Exception, SystemExit) as reason:
        del sys.modules[name]
        raise _import_failure(path, str(file), reason) from reason
    finally:
        sys.path.remove(folder)
    setattr(module, _SEAL, _digest(module))
    return module


def _member(module: ModuleType, name: str, place: str) -> Any:
    if not hasattr(module, name):
        raise ParameterError(f"{place}: there is no {name} in it{_listed(module)}")
    return getattr(module, name)


def _classes_in(place: str) -> str:
    """The flows of a file, as a hint; nothing where it cannot be read."""
    if not place.endswith(".py") or not Path(place).is_file():
        return ""
    return _listed(file_module(place))


def _listed(module: ModuleType) -> str:
    found = [name for place, name in _classes if place == module.__name__]
    return f"; its flows: {', '.join(found)}" if found else "; it has no flows"


def _import_failure(asked: str, file: str | None, reason: BaseException) -> ParameterError:
    """One line for whatever goes wrong while a file is imported; `file` is the one whose lines are of interest."""
    if isinstance(reason, SyntaxError):
        return ParameterError(f"{reason.filename or asked}, line {reason.lineno}: {reason.msg}")
    frames = _frames(reason)
    theirs = [frame for frame in frames if frame.filename == file] or [
        frame for frame in frames if not _is_ours(frame.filename) and not frame.filename.startswith("<frozen")]
    place = f"{theirs[-1].filename}, line {theirs[-1].lineno}" if theirs else asked
    return ParameterError(f"{place}: {_words(reason)}")


def _words(reason: BaseException) -> str:
    """An exception in one line; our own speak for themselves."""
    text = " ".join(str(reason).split())
    if isinstance(reason, StabilityError):
        return text
    return f"{type(reason).__name__}: {text}" if text else type(reason).__name__


def _is_ours(filename: str) -> bool:
    return Path(__file__).parent.parent in Path(filename).parents


def note(cls: type) -> None:
    """Remember that the module of a class defines flows: `faults` puts the blame there."""
    if not shipped(cls):
        _classes[cls.__module__, cls.__qualname__] = None


def shipped(cls: type) -> bool:
    """Whether a class belongs to this package, whose tests prove that it keeps the contract."""
    return cls.__module__.partition(".")[0] == _PACKAGE


@contextmanager
def faults() -> Iterator[None]:
    """Turn what goes wrong in the methods of a flow from elsewhere into a ParameterError that names file and line."""
    try:
        yield
    except StabilityError:
        raise
    except Exception as reason:
        theirs = {_file(sys.modules.get(name)) for name, _ in _classes}
        for frame in reversed(_frames(reason)):
            if Path(frame.filename).resolve() in theirs:
                raise ParameterError(f"{frame.filename}, line {frame.lineno} ({frame.name}): {_words(reason)}") \
                    from reason
        raise


def origin(cls: type) -> dict[str, str]:
    """Where a class from elsewhere comes from, for the headers of results: its `source`, and the `digest` of its file.

    The digest covers the file, and the modules beside it that it uses. Empty for the flows of this package.
    """
    if shipped(cls):
        return {}
    module = sys.modules.get(cls.__module__)
    own = getattr(module, _MARK, None)
    digest = getattr(module, _SEAL, None) or _digest(module)
    source = f"{Path(own).name if own else cls.__module__}:{cls.__qualname__}"
    return {"source": source, **({"digest": digest} if digest else {})}


def ticket(cls: type) -> Any:
    """What a worker finds the class by: itself, or its file with the digest that it must have there too."""
    module = sys.modules.get(cls.__module__)
    file = getattr(module, _MARK, None)
    return (file, cls.__qualname__, getattr(module, _SEAL)) if file else cls


def revive(given: Any, values: dict[str, Any]) -> Any:
    """Return the flow of a `ticket` with these parameters; ParameterError where its file has changed meanwhile."""
    if isinstance(given, tuple):
        file, qualname, digest = given
        given = file_module(file)
        if getattr(given, _SEAL) != digest:
            raise ParameterError(f"{file}: has changed while it was in use; start again")
        for part in qualname.split("."):
            given = getattr(given, part)
    return given(**values)


def _file(module: Any) -> Path | None:
    """The Python file of a module, if there is one."""
    name = getattr(module, _MARK, None) or getattr(module, "__file__", None)
    return Path(name).resolve() if name and name.endswith(".py") else None


def _digest(module: Any) -> str | None:
    """Digest of the file of a module and of those beside it whose things it uses; None where it has no file."""
    files = _files(module)
    content = b"".join(file.read_bytes() for file in files if file.is_file())
    return f"sha256:{_digits_of(content)}" if files else None


def _files(module: Any) -> list[Path]:
    """The file of a module, and those in its folder of the modules whose things it uses, by name."""
    file = _file(module)
    found, left = {file: module} if file else {}, [module] if file else []
    while left:
        for thing in list(vars(left.pop()).values()):
            other = thing if isinstance(thing, ModuleType) else sys.modules.get(str(getattr(thing, "__module__", "")))
            beside = _file(other)
            if beside and file and beside.parent == file.parent and beside not in found:
                found[beside] = other
                left.append(other)
    return sorted(found)


def _digits_of(content: bytes) -> str:
    from hashlib import sha256  # slow to import, and of no use where all flows are those of this package

    return sha256(content).hexdigest()[:_DIGITS]


def _frames(reason: BaseException) -> Any:
    """The frames in which an exception passed, outermost first."""
    from traceback import extract_tb  # slow to import

    return extract_tb(reason.__traceback__)
