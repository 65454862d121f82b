"""Rules of pages and of words: links, names of files, indexes, plain English, quoted code."""
import pathlib
import re

from tree import SOURCE

# Headers of other projects that pages name; and names that are an example's.
OF_OTHERS = {"serial_can_mux.hpp", "name.hpp", "theirs.hpp"}

EXAMPLES = r"\b(?:FLOOR|NAME|theirs)\b"

IDIOMS = re.compile(r"\b(?:(?:no|some|any|every)body|who(?:m)?ever|wish(?:es|ed)?|anew|(?:is|are|be|was|were)\s+told|(?:is|are)\s+wanted"
                    r"|stands?\s+still|stood\s+still|in\s+vain|in\s+one\s+breath|of\s+its\s+own\s+accord)\b", re.IGNORECASE)


def pages(tree):
    return [name for name in tree.files if name.endswith(".md")]


def without_fences(text):
    """Fenced and inline code blanked."""
    text = re.sub(r"(?ms)^( *)```.*?^\1```", lambda m: re.sub(r"[^\n]", " ", m.group(0)), text)
    return re.sub(r"`[^`\n]*`", lambda m: " " * len(m.group(0)), text)


def links(tree, page):
    """(line, file or '', anchor or '') of every relative link; the file as a path from the root."""
    folder = pathlib.PurePosixPath(page).parent
    for line, match in tree.find(page, r"\]\(([^)\s]+)(?:\s+\"[^\"]*\")?\)", without_fences(tree.text(page))):
        link = match.group(1)
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        parts = []
        for part in (folder / path).parts if path else ():
            if part == ".." and parts and parts[-1] != "..":
                parts.pop()
            elif part != ".":
                parts.append(part)
        yield line, link, "/".join(parts) if path else page, anchor


def anchors(text):
    """The anchors of a page's headings, as GitHub makes them."""
    found = set()
    fenced = re.sub(r"(?ms)^( *)```.*?^\1```", "", text)
    for heading in re.findall(r"(?m)^#+ +(.*?) *#*$", fenced):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        found.add(re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-"))
    return found


def links_resolve(tree):
    """Relative links lead to a file, a folder or a heading."""
    folders = {str(parent) for name in tree.files for parent in pathlib.PurePosixPath(name).parents}
    for page in pages(tree):
        for line, link, target, anchor in links(tree, page):
            if target not in tree.known and target not in folders:
                yield f"{page}:{line}: the link ({link}) leads nowhere: there is no {target}"
            elif anchor and target.endswith(".md") and anchor not in anchors(tree.text(target)):
                yield f"{page}:{line}: the link ({link}) leads nowhere: {target} has no heading '{anchor}'"


def named_files_exist(tree):
    """A file or folder of the project that a page names in code or in a link is there; so is the program unit_NAME.
    Decisions and the changelog speak of the past; how-to pages make files, and are followed by a test."""
    folders = {str(parent) for name in tree.files for parent in pathlib.PurePosixPath(name).parents}
    tops = {name.split("/")[0] for name in tree.files if "/" in name}
    paths = tree.known | folders
    ends = {"/".join(name.split("/")[i:]) for name in tree.known for i in range(name.count("/") + 1)}
    units = {name[len(room):].rsplit("/", 1)[0].replace("/", "_") for room in ("tests/unit/", "tests/tool/")
             for name in tree.below(room)}
    for page in pages(tree):
        if page.startswith(("docs/decisions/", "docs/howto/")) or page == "CHANGELOG.md":
            continue
        folder = page.rpartition("/")[0]
        text = re.sub(r"\]\([^)\n]*\)", "]", tree.text(page))  # where links lead is another rule's
        for line, match in tree.find(page, r"(?<![\w.${}<>@:~/-])[\w.-]+(?:/[\w.*<>-]+)+", text):
            word = match.group(0).rstrip("./")
            if word.split("/")[0] not in tops or re.search(EXAMPLES, word):
                continue
            pattern = re.compile(re.sub(r"\\\*|<[^>]*>", "[^/]*", f"(?:{re.escape(folder)}/)?{re.escape(word)}"))
            if not any(map(pattern.fullmatch, paths)):
                yield f"{page}:{line}: there is no {word}"
        for line, match in tree.find(page, r"`([\w./-]+\.hpp)`", text):
            if match.group(1) not in ends | OF_OTHERS:
                yield f"{page}:{line}: there is no {match.group(1)}; a header of another project belongs into OF_OTHERS here"
        for line, match in tree.find(page, r"\[`?([\w./-]+\.\w+)`?\]\(([^)#\s]+)"):
            name = match.group(1).rsplit("/", 1)[-1]
            if re.search(r"\.(?:hpp|cpp|py|json|md)$", name) and match.group(2).rsplit("/", 1)[-1] != name:
                yield f"{page}:{line}: the link is called {match.group(1)} and leads to {match.group(2)}"
        for line, match in tree.find(page, r"\bunit_(\w+)"):
            if match.group(1) not in units | {"name"}:  # a member of specs
                yield f"{page}:{line}: there is no program {match.group(0)}: tests/unit has no such floor"


def tables_are_whole(tree):
    """A table begins with its header: behind a blank line in its middle the rows are text."""
    for page in pages(tree):
        text = re.sub(r"(?ms)^( *)```.*?^\1```", lambda m: re.sub(r"[^\n]", " ", m.group(0)), tree.text(page))
        for line, _ in tree.find(page, r"(?m)(?:\A|(?<=\n\n))\|.*\n(?!\|[ :|-]+\|\n)", text):
            yield f"{page}:{line}: rows of a table without its header: leave out the blank line above"


def words_are_plain(tree):
    """No idiom where a plain word does, in pages, messages, comments, names and tests: `no board`, `is reported`, `expected ...`."""
    folders = ("bench/", "cli/", "examples/", "firmware/", "generator/", "include/", "sim/", "spec/", "tests/")
    sources = tree.below(*folders, ends=SOURCE + (".py", ".json", ".dbc", "CMakeLists.txt")) + tree.below("scripts/", ends="")
    for name in pages(tree) + sources:
        if name.startswith(("docs/decisions/", "tests/rules/architecture/")) or name == "CHANGELOG.md":  # the past; this rule
            continue
        for line, match in tree.find(name, IDIOMS):
            yield f"{name}:{line}: '{match.group(0)}': say who or what does it, in the field's word"


def pages_are_linked(tree):
    """Every page of docs can be reached from another one."""
    linked = {target for page in pages(tree) for _, _, target, _ in links(tree, page) if target != page}
    for page in pages(tree):
        if page.startswith("docs/") and page not in linked:
            yield f"{page}:1: no other page links to it; add it to an index, docs/README.md for instance"


def indexes_are_complete(tree):
    """docs/README.md lists every page of docs once; in a folder with a README.md of its own, that one does."""
    for page in pages(tree):
        folder = str(pathlib.PurePosixPath(page).parent)
        index = f"{folder}/README.md" if f"{folder}/README.md" in tree.known else "docs/README.md"
        if not page.startswith("docs/") or page == index:
            continue
        times = [target for _, _, target, _ in links(tree, index)].count(page) if index in tree.known else 0
        if times != 1:
            yield f"{page}:1: {index} lists this page {times} times; expected once"


def test_folders_have_rows(tree):
    """tests/README.md names each folder of tests that has a CMakeLists.txt."""
    rows = tree.text("tests/README.md") if "tests/README.md" in tree.known else ""
    for name in tree.files:
        match = re.fullmatch(r"tests/(\w+/(?:\w+/)?)CMakeLists\.txt", name)
        if match and f"`{match[1]}`" not in rows:
            yield f"{name}:1: tests/README.md has no row for `{match[1]}`"


def folders_are_named(tree):
    """docs/architecture.md names each folder, and each room of cli/, firmware/, generator/ and sim/, or their own README.md does."""
    table = tree.text("docs/architecture.md")
    first = {}
    for name in tree.files:
        folders = name.split("/")[:-1]
        if folders and not folders[0].startswith(".") and folders[0] != "include":
            first.setdefault((folders[0],), name)
            if folders[0] in ("cli", "firmware", "generator", "sim") and len(folders) > 1:
                first.setdefault(tuple(folders[:2]), name)
    for folders, name in first.items():
        own = f"{folders[0]}/README.md"
        words = table + (tree.text(own) if own in tree.known and len(folders) > 1 else "")
        if not re.search(rf"`(?:{folders[0]}/)?{folders[-1]}/", words):
            yield f"{name}:1: docs/architecture.md names no folder {'/'.join(folders)}/; give it a row"


def snippets(tree):
    """Name -> (file, code) of what examples offer to be quoted; indentation taken off."""
    found = {}
    for name in tree.below("examples/"):
        for _, match in tree.find(name, r"(?m)^( *)// snippet: (\S+)\n((?:.*\n)*?) *// endsnippet$"):
            indent, code = match.group(1), match.group(3)
            found[match.group(2)] = (name, re.sub(rf"(?m)^{indent}", "", code))
    return found


def quotes_are_the_examples(tree):
    """Code behind <!-- snippet: NAME --> is the snippet of that name; all C++ of the README is such code."""
    offered = snippets(tree)
    for page in pages(tree):
        for line, match in tree.find(page, r"(?m)^<!-- snippet: (\S+) -->\n+```\w*\n((?:.*\n)*?)```$"):
            if match.group(1) not in offered:
                yield f"{page}:{line}: no file of examples/ has a snippet '{match.group(1)}'"
            elif match.group(2) != offered[match.group(1)][1]:
                yield f"{page}:{line}: not what {offered[match.group(1)][0]} has as '{match.group(1)}'; copy it again"
        for line, match in tree.find(page, r"(?m)^<!-- snippet: (\S+) -->\n+(?!```|\n)"):
            yield f"{page}:{line}: snippet '{match.group(1)}' is announced, and no code follows"
    quoted = re.compile(r"(?m)^(?!<!-- snippet)(.*)\n+```cpp$")
    for line, match in tree.find("README.md", quoted) if "README.md" in tree.known else ():
        line += match.group(0).count("\n")
        yield f"README.md:{line}: C++ in the README is quoted: put '<!-- snippet: NAME -->' above it"


RULES = (links_resolve, named_files_exist, tables_are_whole, words_are_plain, pages_are_linked, indexes_are_complete,
         test_folders_have_rows, folders_are_named, quotes_are_the_examples)
