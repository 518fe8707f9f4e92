"""Archives as the subcommands of treb-plot read them."""

from .accessor import Treb
from .api import open_archive
from .program import limited_cpu_time, note


def load(path):
    """The archive at `path`."""
    with limited_cpu_time():
        return Treb(open_archive(path))


def reported(archive):
    """An archive, whose progress is printed on stderr if it is unfinished."""
    if not archive.complete:
        note(f"{archive.path}: {archive.progress()}; the rest is left blank")
    return archive


def select(archive, at, option="at"):
    """The scenes of an archive that `at` selects."""
    return reported(archive.select(at, option))


def only(archive, at=(), option="at"):
    """The one scene of an archive that `at` selects."""
    return reported(archive.only(at, option))
