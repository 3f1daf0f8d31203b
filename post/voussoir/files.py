"""Files that are read and written: text in UTF-8, no pipes, and a new file in place of a link."""

from __future__ import annotations

from pathlib import Path

#: Folders of the system, whose links lead to the output of this process
_SYSTEM = (Path("/dev"), Path("/proc"))


def plain(path: Path) -> Path:
    """The path of a file to be read; ValueError for a pipe or a device, which may have no end."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise ValueError(f"{path}:1: error: expected a file, got a pipe or a device; write its text into a file")
    return path


def read_text(path: Path) -> str:
    """Text of a file, its lines ended by line feeds; ValueError with the line where it is not UTF-8, as in `dda`."""
    content = plain(path).read_bytes()
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = content[: problem.start].replace(b"\r\n", b"\n").replace(b"\r", b"\n").count(b"\n") + 1
        raise ValueError(
            f"{path}:{line}: error: expected text in UTF-8, got the byte 0x{problem.object[problem.start]:02X}; "
            "save the file as UTF-8") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def fresh(path: Path) -> Path:
    """The path of a file to be written. What has that name is removed: a link is replaced, not followed."""
    system = any(folder in path.absolute().parents for folder in _SYSTEM)
    if not system and (path.is_symlink() or path.is_file()):
        path.unlink()
    return path


def write_text(path: Path, text: str) -> Path:
    """Write a text file in UTF-8 in place of what has its name."""
    fresh(path).write_text(text, encoding="utf-8")
    return path
