"""The tree that the rules look at: each file read once."""
import pathlib
import re

import house

SOURCE = (".hpp", ".cpp", ".h", ".c")


class Tree:
    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.files = house.files(root)
        self.known = set(self.files)
        self.floors = house.read_floors(root)
        self.texts = {}
        self.included = {}

    def text(self, name):
        if name not in self.texts:
            try:
                self.texts[name] = (self.root / name).read_text()
            except UnicodeDecodeError:
                self.texts[name] = ""  # not text
        return self.texts[name]

    def below(self, *folders, ends=SOURCE):
        return [name for name in self.files if name.startswith(folders) and name.endswith(ends)]

    def headers(self):
        """(path, floor's name) of all headers of the library."""
        for name in self.below("include/ocm/", ends=(".hpp", ".h")):
            yield name, self.floor(name)

    def floor(self, name):
        """The floor of a file; '' where it is not of the library."""
        return house.floor_of(self.floors, name.removeprefix("include/ocm/")) if name.startswith("include/ocm/") else ""

    def includes(self, name):
        if name not in self.included:
            self.included[name] = house.includes(self.text(name))
        return self.included[name]

    def resolve(self, what):
        """The project's file that an #include means; None where it is not one of ours."""
        for candidate in ("include/" + what, what):
            if candidate in self.known:
                return candidate
        return None

    def find(self, name, pattern, text=None):
        """(line, match) of every match."""
        text = self.text(name) if text is None else text
        for match in re.finditer(pattern, text):
            yield text.count("\n", 0, match.start()) + 1, match
