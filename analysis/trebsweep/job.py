"""Changes the jobs of archives and optima: {(section, key): value}."""

INTEGRATION = ("stepper", "time-step", "tolerance", "target-error", "release-window")


def parse_job(text):
    """Parses the text of a job file into {(section, key): value}."""
    values, section = {}, ""
    for line in text.splitlines():
        if line.startswith("["):
            section = line.strip("[]")
        elif "=" in line:
            key, value = line.split("=", 1)
            values[section, key.strip()] = value.strip()
    return values


def accurate_job(job):
    """The job with the default solver, which is accurate, and a located release instead of the
    window rule."""
    kept = {key: value for key, value in job.items()
            if key not in [("solver", name) for name in INTEGRATION]}
    if kept.get(("solver", "release")) == "window":
        kept["solver", "release"] = "crossing"
    return kept


def without_sections(job, *sections):
    """The job without the keys of some sections."""
    return {key: value for key, value in job.items() if key[0] not in sections}


def job_text(job):
    """The text of a job file."""
    sections = dict.fromkeys(section for section, _ in job)
    return "\n".join(
        f"[{section}]\n" + "".join(f"{key} = {value}\n"
                                   for (name, key), value in job.items() if name == section)
        for section in sections)
