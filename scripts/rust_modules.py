"""Reads which modules of a Rust crate name which others.

Works on the text alone, without a compiler: a file names another where one of its paths
begins with `crate::`, `super::` or `self::`, or with a name that such a path imported.
Tests, `lib.rs` and `main.rs` are left out.
"""

import re
from collections import defaultdict

# A module is the tuple of its names below the crate: ("alerts", "rules").
ROOT = ()
CRATE_ROOTS = {"lib.rs", "main.rs"}

COMMENT_OR_LITERAL = re.compile(
    r"""//[^\n]*
    | /\*.*?\*/
    | (?<!\w)b?r(?P<hashes>\#*)".*?"(?P=hashes)
    | "(?:\\.|[^"\\])*"
    | '(?:\\.[^']*|[^\\'])'
    """,
    re.VERBOSE | re.DOTALL,
)
TEST_ITEM = re.compile(r"#\[cfg\(test\)\]")
USE = re.compile(r"\b(?P<public>pub(?:\([^)]*\))?\s+)?use\s+(?P<tree>[^;]*);")
RELATIVE_PATH = re.compile(r"\b(?:crate|super|self)(?:::\w+)+")
PATH = re.compile(r"(?<![:\w])(?P<first>\w+)(?P<rest>(?:::\w+)+)")


class Crate:
    """The modules of one crate, from its files' text by their path below `src`."""

    def __init__(self, sources):
        self.files = {}
        self.code = {}
        self.product_lines = 0
        for path, text in sorted(sources.items()):
            if is_test_file(path):
                continue
            code = without_tests(without_comments(text))
            self.product_lines += code.count("\n")
            if path in CRATE_ROOTS:
                continue
            module = module_of(path)
            self.files[module] = path
            self.code[module] = code
        self.exports = {module: dict(exports(code)) for module, code in self.code.items()}

    def references(self, through_exports=False):
        """Returns {module: {module it names, …}}.

        Only paths that begin with `crate`, `super` or `self` count, and for the module
        that they name. With `through_exports` a re-exported name counts for the module
        that defines it, and so does what a module takes from its children by their bare
        names.
        """
        found = defaultdict(set)
        for module, code in self.code.items():
            for path in self.paths(module, code, through_exports):
                target = self.resolve(module, path, through_exports)
                if target not in (None, ROOT, module):
                    found[module].add(target)
        return found

    def paths(self, module, code, through_exports):
        """Yields every path in a module's code that may lead to another module."""
        imported = {}
        if through_exports:
            imported = {child[-1]: ["self", child[-1]] for child in self.files if child[:-1] == module}
        for use in USE.finditer(code):
            for path, name in use_tree(use["tree"]):
                if not (is_relative(path) or through_exports and self.is_child(module, path)):
                    continue
                imported[name] = path
                # Who re-exports a name does not use it; whoever takes it from here does.
                if not (use["public"] and through_exports):
                    yield path
        body = USE.sub("", code)
        for match in RELATIVE_PATH.finditer(body):
            yield match[0].split("::")
        for match in PATH.finditer(body):
            if match["first"] in imported:
                yield imported[match["first"]] + match["rest"].strip(":").split("::")

    def is_child(self, module, path):
        """Says whether a path begins with the bare name of a module's child."""
        return (*module, path[0]) in self.files

    def resolve(self, module, path, through_exports, depth=0):
        """Returns the module that a path written in `module` leads to, or None."""
        absolute = absolute_path(module, path)
        if absolute is None:
            return None
        length = len(absolute)
        while length and tuple(absolute[:length]) not in self.files:
            length -= 1
        target, rest = tuple(absolute[:length]), absolute[length:]
        exported = self.exports.get(target, {}).get(rest[0]) if rest else None
        if through_exports and exported and depth < 8:
            if is_relative(exported) or self.is_child(target, exported):
                return self.resolve(target, exported + rest[1:], True, depth + 1)
        return target


def is_relative(path):
    """Says whether a path leads into its own crate by its first word."""
    return path[0] in ("crate", "super", "self")


def is_test_file(path):
    """Says whether a file below `src` is compiled for tests alone."""
    parts = path.removesuffix(".rs").split("/")
    return "tests" in parts or "test" in parts or parts[-1] == "test_support"


def module_of(path):
    """Returns the module of a file: `a/b.rs` and `a/b/mod.rs` are ("a", "b")."""
    parts = path.removesuffix(".rs").split("/")
    return tuple(parts[:-1] if parts[-1] == "mod" else parts)


def without_comments(text):
    """Blanks comments and literals, line by line, so that none is taken for code."""

    def blank(match):
        quotes = "" if match[0].startswith("/") else '""'
        return quotes + "\n" * match[0].count("\n")

    return COMMENT_OR_LITERAL.sub(blank, text)


def without_tests(code):
    """Removes each item behind `#[cfg(test)]`, from code without comments and literals."""
    while match := TEST_ITEM.search(code):
        code = code[: match.start()] + code[end_of_item(code, match.end()) :]
    return code


def end_of_item(code, start):
    """Returns where the item that begins at `start` ends: at its `;` or last brace."""
    depth = 0
    for position in range(start, len(code)):
        character = code[position]
        if character in "{([":
            depth += 1
        elif character in "})]":
            depth -= 1
        if depth == 0 and character in "};":
            return position + 1
    return len(code)


def exports(code):
    """Yields (name, path) of each `pub use`."""
    for use in USE.finditer(code):
        if use["public"]:
            for path, name in use_tree(use["tree"]):
                yield name, path


def use_tree(text):
    """Yields (path, name) of each leaf of a use declaration: `a::{b, c as d}`."""
    text = text.strip()
    group = re.fullmatch(r"(?P<head>[^{]*)\{(?P<items>.*)\}", text, re.DOTALL)
    if group:
        head = split_path(group["head"])
        for item in split_items(group["items"]):
            for path, name in use_tree(item):
                yield head + [part for part in path if part != "self" or not head], name
        return
    path, _, alias = text.partition(" as ")
    path = split_path(path)
    if path:
        yield path, alias.strip() or path[-1]


def split_path(text):
    return [part.strip() for part in text.split("::") if part.strip()]


def split_items(text):
    """Splits at the commas that stand outside braces."""
    items, depth = [""], 0
    for character in text:
        depth += (character == "{") - (character == "}")
        if character == "," and depth == 0:
            items.append("")
        else:
            items[-1] += character
    return [item for item in items if item.strip()]


def absolute_path(module, path):
    """Returns a path from the crate's root; None where `super` leaves the crate."""
    current, rest = list(module), list(path)
    if rest[0] == "crate":
        return rest[1:]
    while rest and rest[0] in ("super", "self"):
        if rest.pop(0) == "super":
            if not current:
                return None
            current.pop()
    return current + rest
