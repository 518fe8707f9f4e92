"""The planes of an archive through its optimum, for the explorer's page."""

import base64
import gzip

from trebsweep.accessor import key_of
from trebsweep.backend import AXES
from trebsweep.program import fail
from trebsweep.scenes import load, only

NOT_COMPUTED = ["steps", "speed_error", "stiffness", "decay_rate"]  # by the page
LARGEST_COUNT = 150  # values kept along an axis; a finer lattice is thinned out


def stored_planes(path, at):
    """What stored.js shows of an archive, of a study the scene that `at` selects: name, job, field,
    design (m), progress (a text, empty if complete), an object {first, step, count} for each axis, and planes: by the
    axis that is constant, base64 of gzipped 32-bit floats."""
    archive = only(load(path), at)
    optimum = archive.optimum()
    if optimum is None:
        fail(f"{path}: has no optimum through which planes could be drawn: {archive.best_text()}")
    dataset = shown_field(archive)

    centre = [archive.nearest(axis, optimum[0][axis]) for axis in AXES]
    kept = [slice(index % stride, None, stride) for index, stride in zip(
        centre, (-(-count // LARGEST_COUNT) for count in (archive.data.sizes[axis] for axis in AXES)))]

    def plane(across):
        """Every stride-th value of the plane through the optimum on which an axis is constant."""
        where = [centre[axis] if axis == across else kept[axis] for axis in range(len(AXES))]
        return packed(archive.data[dataset].isel(dict(zip(AXES, where))).values)

    return {
        "name": archive.name(),
        "job": archive.job,
        "field": key_of(dataset),
        "progress": "" if archive.complete else archive.progress(),
        "design": {axis: float(archive.axes[axis][i]) for axis, i in zip(AXES, centre)},
        **{axis: summary(archive.axes[axis][own]) for axis, own in zip(AXES, kept)},
        "planes": {axis: plane(across) for across, axis in enumerate(AXES)},
    }


def shown_field(archive):
    """The dataset of the objective if it is stored, otherwise of the speed or the first map that the page can show."""
    objective = archive.objective[0].replace("-", "_")
    for name in (objective, "speed", *archive.fields):
        if name in archive.fields and archive.is_number(name) and name not in NOT_COMPUTED:
            return name
    return fail(f"{archive.path}: has no map that the explorer shows")


def summary(values):
    """First value, step and number of the values of an axis, which are evenly spaced."""
    step = values[1] - values[0] if len(values) > 1 else values[0] / 10
    return {"first": float(values[0]), "step": round(float(step), 12), "count": len(values)}


def packed(plane):
    return base64.b64encode(gzip.compress(plane.astype("<f4").tobytes(), 9, mtime=0)).decode()
