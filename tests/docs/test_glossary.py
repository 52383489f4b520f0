"""The glossary is short, in order, and found from where its terms are used."""

import re

from sim.commands.parsing import parser
from tests.pages import README, ROOT

PAGE = ROOT / "docs" / "glossary.md"
TERMS = dict(
    re.findall(r"^## ([^\n]+)\n\n(.+?)\n*(?=^## |\Z)", PAGE.read_text(), re.M | re.S)
)
READERS = ("commands", "index", "method", "numbers", "robots", "servos", "systems")


def test_terms_are_few_and_in_alphabetical_order():
    assert 20 < len(TERMS) <= 30
    assert list(TERMS) == sorted(TERMS, key=str.lower)


def test_every_term_is_defined_in_a_few_sentences():
    sentences = {
        term: len(re.findall(r"[.?](?:\s|$)", text)) for term, text in TERMS.items()
    }
    assert {term: n for term, n in sentences.items() if not 1 <= n <= 3} == {}


def test_readme_pages_and_help_lead_to_the_glossary():
    assert "(docs/glossary.md)" in README.read_text()
    pages = {name: (PAGE.parent / f"{name}.md").read_text() for name in READERS}
    assert [name for name, text in pages.items() if "glossary" not in text] == []
    assert "docs/glossary.md" in parser().format_help()


def test_reports_explain_their_words_as_the_glossary_does():
    texts = {re.sub(r"[`*]", "", " ".join(text.split())) for text in TERMS.values()}
    parts = (ROOT / "sim" / "templates" / "parts.html").read_text()
    shown = re.findall(r'^  "[a-z, -]+": "(.+)",$', parts, re.MULTILINE)
    assert len(shown) > 5
    assert set(shown) <= texts
