#!/usr/bin/env python3
"""The rules of docs/architecture.md, checked: check.py ROOT [RULE ...]. Each violation is a line with file, line, what
is wrong and what would be right; exit 1 if there are any. Without RULE all are checked; --list names them."""
import sys

import house
import pages
import sources
from tree import Tree

RULES = sources.RULES + pages.RULES


def check(root, rules=RULES):
    """[(rule's name, violation)]"""
    try:
        tree = Tree(root)
    except house.TableError as error:
        return [("floor_table", str(error))]
    return [(rule.__name__, violation) for rule in rules for violation in rule(tree)]


def main(arguments):
    if arguments[:1] == ["--list"]:
        for rule in RULES:
            print(f"{rule.__name__:34} {rule.__doc__}")
        return 0
    by_name = {rule.__name__: rule for rule in RULES}
    if not arguments or any(name not in by_name for name in arguments[1:]):
        print("usage: check.py ROOT [RULE ...] | --list", file=sys.stderr)
        return 2
    found = check(arguments[0], [by_name[name] for name in arguments[1:]] or RULES)
    for rule, violation in found:
        print(f"{violation} [{rule}]")
    print(f"{len(found)} violations of the architecture" if found else "the architecture holds")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
