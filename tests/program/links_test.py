"""The Markdown files."""

import os
import re
import subprocess
import unittest

REPOSITORY = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))


def markdown_files():
    listed = subprocess.run(["find", ".", "-name", "*.md", "-not", "-path", "./build/*", "-not", "-path", "./results/*"],
                            cwd=REPOSITORY, text=True, capture_output=True, check=True).stdout.splitlines()
    return [os.path.normpath(name) for name in listed]


def text_of(name):
    with open(os.path.join(REPOSITORY, name), encoding="utf-8") as file:
        return re.sub(r"^```.*?^```", "", file.read(), flags=re.MULTILINE | re.DOTALL)


def anchors(name):
    """The anchors that GitHub gives to headings."""
    headings = re.findall(r"^#+ (.*)$", text_of(name), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


class Links(unittest.TestCase):
    def test_every_relative_link_leads_to_a_file_and_a_heading(self):
        broken = []
        for name in markdown_files():
            for target in re.findall(r"\]\(([^)\s]+)\)", text_of(name)):
                path, _, anchor = target.partition("#")
                if "://" in target:
                    continue
                file = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
                exists = os.path.exists(os.path.join(REPOSITORY, file))
                if not exists or (anchor and anchor not in anchors(file)):
                    broken.append(f"{name}: {target}")
        self.assertEqual(broken, [])


if __name__ == "__main__":
    unittest.main()
