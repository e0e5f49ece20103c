# SPDX-License-Identifier: GPL-3.0-or-later
"""Markdown, as README.md and docs/ are written in it, as pages for a browser that has no network. The package has them."""

import html
import re
import shutil
from pathlib import Path

STYLE = """body{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222;background:#fff}
code,pre{font-size:.9em;background:#f3f3f3;border-radius:3px}code{padding:0 .2em}pre{padding:.7em;overflow:auto}
pre code{padding:0}table{border-collapse:collapse;display:block;overflow:auto}td,th{border:1px solid #ccc;padding:.2em .5em;
vertical-align:top;text-align:left}img{max-width:100%}a{color:#05a}nav{border-bottom:1px solid #ccc;padding-bottom:.5em}"""


def page(markdown: str, title: str, navigation: str = "") -> str:
    """A whole page; links to other pages of Markdown lead to those of this form."""
    body = "\n".join(_blocks(markdown.split("\n")))
    head = f'<meta charset="utf-8"><title>{html.escape(title)}</title><style>{STYLE}</style>'
    return f"<!DOCTYPE html>\n<html lang=en><head>{head}</head><body>{navigation}{body}</body></html>\n"


def _blocks(lines: list[str]) -> list[str]:
    out: list[str] = []
    at = 0
    while at < len(lines):
        line = lines[at]
        if line.lstrip().startswith("```"):
            end = next(i for i in range(at + 1, len(lines)) if lines[i].lstrip().startswith("```"))
            out.append(f"<pre><code>{html.escape(chr(10).join(lines[at + 1 : end]))}</code></pre>")
            at = end + 1
        elif match := re.match(r"(#{1,6}) (.*)", line):
            level = len(match[1])
            out.append(f'<h{level} id="{anchor(match[2])}">{_inline(match[2])}</h{level}>')
            at += 1
        elif _begins_table(lines, at):
            end = _while(lines, at, lambda text: text.startswith("|"))
            out.append(_table(lines[at:end]))
            at = end
        elif match := re.match(r"(- |\d+\. )", line):
            end = _while(lines, at, lambda text: bool(re.match(r"- |\d+\. | +\S", text)))
            out.append(_list(lines[at:end], "ul" if match[1] == "- " else "ol"))
            at = end
        elif line.strip():
            end = at + 1
            while end < len(lines) and not _begins_another(lines, end):
                end += 1
            out.append(f"<p>{_inline(' '.join(lines[at:end]))}</p>")
            at = end
        else:
            at += 1
    return out


def _begins_table(lines: list[str], at: int) -> bool:
    return lines[at].startswith("|") and at + 1 < len(lines) and bool(re.match(r"\|[-:| ]+\|$", lines[at + 1]))


def _begins_another(lines: list[str], at: int) -> bool:
    """Than the paragraph before."""
    return not lines[at].strip() or bool(re.match(r"```|#{1,6} |- |\d+\. ", lines[at])) or _begins_table(lines, at)


def _while(lines: list[str], at: int, condition) -> int:
    while at < len(lines) and condition(lines[at]):
        at += 1
    return at


def _list(lines: list[str], kind: str) -> str:
    items: list[list[str]] = []
    for line in lines:
        if match := re.match(r"(- |\d+\. )(.*)", line):
            items.append([match[2]])
        else:
            items[-1].append(re.sub(r"^ {1,3}", "", line))
    return f"<{kind}>{''.join(f'<li>{_item(item)}</li>' for item in items)}</{kind}>"


def _item(lines: list[str]) -> str:
    plain = _while(lines, 0, lambda text: not re.match(r"```|- |\d+\. |\|", text))
    return "\n".join([_inline(" ".join(lines[:plain])), *_blocks(lines[plain:])])


def _table(lines: list[str]) -> str:
    rows = [
        [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line.strip()[1:].removesuffix("|"))]
        for line in lines
    ]
    head = "".join(f"<th>{_inline(cell)}</th>" for cell in rows[0])
    body = "".join("<tr>" + "".join(f"<td>{_inline(cell)}</td>" for cell in row) + "</tr>" for row in rows[2:])
    return f"<table><tr>{head}</tr>{body}</table>"


def anchor(heading: str) -> str:
    """What links to a heading call it: as GitHub does."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def _inline(text: str) -> str:
    """Code first: nothing in it means anything else."""
    codes: list[str] = []

    def keep(match: re.Match[str]) -> str:
        codes.append(f"<code>{html.escape(match[2])}</code>")
        return f"\0{len(codes) - 1}\0"

    text = html.escape(re.sub(r"(`+)(.+?)\1", keep, text), quote=False)
    text = re.sub(r"!\[([^\]]*)\]\(([^)\s]+)\)", r'<img src="\2" alt="\1">', text)
    text = re.sub(r"\[([^\]]*)\]\(([^)\s]+)\)", lambda m: f'<a href="{_target(m[2])}">{m[1]}</a>', text)
    text = re.sub(r"\*\*(?=\S)(.+?)(?<=\S)\*\*", r"<strong>\1</strong>", text)
    text = re.sub(r"(?<![\w*])\*(?=\S)([^*]+?)(?<=\S)\*(?![\w*])", r"<em>\1</em>", text)
    return re.sub(r"\0(\d+)\0", lambda m: codes[int(m[1])], text)


def _target(link: str) -> str:
    return re.sub(r"^(?!\w+:)([^#]*)\.md(?=$|#)", r"\1.html", link)


def write(root: Path, folder: Path) -> None:
    """README.md and docs/ of the checkout `root` into `folder`: README.html, docs/*.html, docs/images."""
    sources = [root / "README.md", *sorted((root / "docs").glob("*.md"))]
    for source in sources:
        place = source.relative_to(root)
        up = "../" * (len(place.parts) - 1)
        links = " · ".join(
            f'<a href="{up}{other.relative_to(root).with_suffix(".html")}">{other.stem}</a>' for other in sources
        )
        to = (folder / place).with_suffix(".html")
        to.parent.mkdir(parents=True, exist_ok=True)
        to.write_text(
            page(source.read_text(encoding="utf-8"), f"WardMIS: {source.stem}", f"<nav>{links}</nav>"),
            encoding="utf-8",
        )
    shutil.copytree(root / "docs" / "images", folder / "docs" / "images", dirs_exist_ok=True)
    shutil.copy(root / "LICENSE", folder / "LICENSE")
