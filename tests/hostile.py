"""Names that do harm where they are written without care, drawn at random."""

import json
import random
import shutil

from models.description.robot import FOLDER

PARTS = (
    *"\n\r\t\0\x0b\x0c\x1b\x1c\x85\x7f\u2028\u2029\u202e\u200b\ufeff\xa0\ud800",
    *"\\\"'`,;:|&<>$%{}[]()#!?*/=~^@+- .x1éß漢😀",
    "\r\n", "\\\n", "\x1b[2J", "??/", "??/\n", "*/", "/*", "//", "-->", "]]>", "<!--",
    "#error INJECTED", '#include "/etc/hostname"', "</script>", "<script>alert(1)",
    "<img src=x onerror=alert(1)>", "</title>", "</pre>", "<svg/onload=alert(1)>",
    "&lt;", "&#10;", "{{ 7 * 7 }}", "{% raw %}", "{0.__class__}", "%s%n", "$(id)",
    "$\\frac{1}{0}$", "\\input{x}", "- a\n", ": ", "&a [*a]", "!!python/name:os.system",
    "=1+1", "nan", "null", "true", "~", "1e5", "0x10", "[table]", '"""', "'''",
)  # fmt: skip


def names(count, seed=0):
    """Different names, most of which no reader expects."""
    dice, found = random.Random(seed), {}
    while len(found) < count:
        parts = dice.choices(PARTS, k=dice.choice((1, 1, 2, 3, 6)))
        found["".join(parts)] = None
    return list(found)


def elements(text):
    """Names of the elements of a page, in order, and the number of its attributes."""
    from html.parser import HTMLParser

    found = []

    class Reader(HTMLParser):
        def handle_starttag(self, tag, attributes):
            found.append((tag, len(attributes)))

    Reader().feed(text)
    return found


def named_otherwise(folder, joint, file="mine"):
    """The shipped hexapod with another name of its first swing joint."""
    text = (FOLDER / "hexapod.xml").read_text()
    text = text.replace('"swing_1"', f'"{joint}"')
    card = (FOLDER / "hexapod.toml").read_text()
    told = json.loads(json.dumps(joint)).replace("&#10;", "\n").replace("&#13;", "\r")
    (folder / f"{file}.xml").write_text(text)
    (folder / f"{file}.toml").write_text(
        card.replace('"swing_1"', json.dumps(told, ensure_ascii=False))
    )
    shutil.copy(FOLDER / "scene.xml", folder)
    return folder / f"{file}.xml"
