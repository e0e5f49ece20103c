# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation as pages: every construct that it is written with, and no link that leads nowhere."""

import html.parser
import re
import tempfile
import unittest
from pathlib import Path
from urllib.parse import unquote

import pages

ROOT = Path(__file__).resolve().parents[2]


class Reader(html.parser.HTMLParser):
    """Links, places that can be linked to, and the text outside of code."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links, self.places, self.text, self.open = [], set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.links += [values[name] for name in ("href", "src") if name in values]
        if "id" in values:
            self.places.add(values["id"])
        if tag not in {"img", "meta"}:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, (tag, self.getpos())

    def handle_data(self, data):
        if not {"code", "pre", "style"} & set(self.open):
            self.text.append(data)


class Constructs(unittest.TestCase):
    def body(self, markdown: str) -> str:
        return re.search(r"<body>(.*)</body>", pages.page(markdown, "T"), re.S)[1]

    def test_each(self):
        for markdown, expected in (
            ("a *b* **c** d*e*f 2 * 3 * 4", "<p>a <em>b</em> <strong>c</strong> d*e*f 2 * 3 * 4</p>"),
            (
                "`a *b* <c>` & [d](e.md#f) <g>",
                '<p><code>a *b* &lt;c&gt;</code> &amp; <a href="e.html#f">d</a> &lt;g&gt;</p>',
            ),
            ("one\ntwo\n\nthree", "<p>one two</p>\n<p>three</p>"),
            (
                "![a](b.png) [w](https://x.org/a.md)",
                '<p><img src="b.png" alt="a"> <a href="https://x.org/a.md">w</a></p>',
            ),
            ("## A `b` (c)", '<h2 id="a-b-c">A <code>b</code> (c)</h2>'),
            ("```\n# <x>\n```\nafter", "<pre><code># &lt;x&gt;</code></pre>\n<p>after</p>"),
            ("a\n|s|² is 1\nb", "<p>a |s|² is 1 b</p>"),
            ("- a\n  b\n- c\n\nd", "<ul><li>a b</li><li>c</li></ul>\n<p>d</p>"),
            ("1. a\n2. b", "<ol><li>a</li><li>b</li></ol>"),
            (
                "| a | b |\n|---|---|\n| `c\\|d` | e |",
                "<table><tr><th>a</th><th>b</th></tr><tr><td><code>c|d</code></td><td>e</td></tr></table>",
            ),
        ):
            self.assertEqual(self.body(markdown), expected)


class Documentation(unittest.TestCase):
    def test_every_link_leads_somewhere_and_nothing_stays_markdown(self):
        with tempfile.TemporaryDirectory() as folder:
            pages.write(ROOT, Path(folder))
            read = {path: Reader(path.read_text(encoding="utf-8")) for path in Path(folder).rglob("*.html")}
            self.assertGreater(len(read), 6)
            for path, page in read.items():
                self.assertEqual(page.open, [], path)
                for mark in (r"\*\*", r"\]\([^\s)]+\.(md|png)", "```", "\0", r"\|--", r"\\\|"):
                    self.assertNotRegex("".join(page.text), mark)
                for link in page.links:
                    if re.match(r"\w+:", link):
                        continue
                    name, _, place = unquote(link).partition("#")
                    target = (path.parent / name).resolve() if name else path
                    self.assertTrue(target.is_file(), f"{path.name}: {link}")
                    if place:
                        self.assertIn(place, read[target].places, f"{path.name}: {link}")
