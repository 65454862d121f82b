"""The tree as the rules see it: its files, its floors (the table in docs/architecture.md), its includes."""
import pathlib
import re
import shutil
import subprocess

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


class TableError(Exception):
    """The floor table cannot be read, or contradicts itself."""


class Floor:
    def __init__(self, number, name, may_include, board):
        self.number = number
        self.name = name
        self.may_include = may_include  # as the table has it
        self.reach = set()              # with all that these may include, and itself
        self.board = board              # compiles for a board


def read_floors(root):
    """Name -> Floor, in the table's order. Raises TableError."""
    page = pathlib.Path(root, "docs/architecture.md")
    if not page.is_file():
        raise TableError("docs/architecture.md: there is no such page, and with it no floor table")
    table = re.search(r"<!-- floors:.*?-->(.*?)<!-- end of floors -->", page.read_text(), re.DOTALL)
    if not table:
        raise TableError("docs/architecture.md: no table between '<!-- floors: ... -->' and '<!-- end of floors -->'")
    floors = {}
    for line in table.group(1).splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) != 5 or not cells[0].isdigit():
            continue
        name = cells[1].strip("`")
        floors[name] = Floor(int(cells[0]), name, re.findall(r"`([\w/]+)`", cells[3]), "board" in cells[4])
    if not floors:
        raise TableError("docs/architecture.md: the floor table has no rows")
    for floor in sorted(floors.values(), key=lambda f: f.number):
        floor.reach = {floor.name}
        for below in floor.may_include:
            if below not in floors:
                raise TableError(f"docs/architecture.md: floor '{floor.name}' may include '{below}', which has no row")
            if floors[below].number >= floor.number:
                raise TableError(f"docs/architecture.md: floor '{floor.name}' ({floor.number}) may include '{below}' "
                                 f"({floors[below].number}), which is not below it")
            floor.reach |= floors[below].reach
        for below in sorted(floor.reach):
            if floor.board and not floors[below].board:
                raise TableError(f"docs/architecture.md: floor '{floor.name}' runs on a board, '{below}' does not")
    return floors


def direct(floors, floor):
    """What a floor may include and reaches through nothing else: the arrows of docs/images/house.svg."""
    return [below for below in floor.may_include
            if not any(below in floors[other].reach for other in floor.may_include if other != below)]


def floor_of(floors, path):
    """The floor of a path below include/ocm: the innermost of its folders that has a row; else its outermost folder."""
    folders = path.split("/")[:-1]
    for depth in range(len(folders), 0, -1):
        if "/".join(folders[:depth]) in floors:
            return "/".join(folders[:depth])
    return folders[0] if folders else ""


def files(root):
    """Every file of the project, as relative posix paths: what git has or would add; without git, or in a tree that is none of
    its checkouts (an archive, also one that is unpacked below another project's), all but build folders."""
    root = pathlib.Path(root)

    def git(*words):
        done = subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True) if shutil.which("git") else None
        return done.stdout if done and done.returncode == 0 else None

    names = None
    if git("rev-parse", "--show-prefix") == "\n":
        names = (git("ls-files", "-z", "--cached", "--others", "--exclude-standard") or "").split("\0")
    if names is None or names == [""]:
        names = [path.relative_to(root).as_posix() for path in root.rglob("*")]
        names = [name for name in names if not re.match(r"(\.git|build[^/]*)/", name)]
    return sorted(name for name in set(names) if name and (root / name).is_file())


def without_comments(code):
    """The code with comments, strings and characters blanked, line by line in place."""
    token = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Fa-f])\'(?:\\.|[^\'\\\n])*\'', re.DOTALL)
    return token.sub(lambda match: re.sub(r"[^\n]", " ", match.group(0)), code)


def includes(code):
    """(line, quoted?, what) of every #include, commented ones left out."""
    kept = re.sub(r"//[^\n]*|/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m.group(0)), code, flags=re.DOTALL)
    return [(kept.count("\n", 0, match.start(2)) + 1, match.group(1) == '"', match.group(2))
            for match in INCLUDE.finditer(kept)]
