"""Makes one file of the folder with the panel. A browser opens it without a web server, such as from a memory stick.

Browsers load no modules and request no files for a page from a file address. So all files are in the document: the styles
in an element `style`, and every other file as the text of an element `script` with its path, which is not executed. The
only scripts that run by themselves are theme.js and one-file.js; the latter makes modules of the texts. The policy of the
page names both by their hashes, so nothing else in the document can run, and it permits no requests.
"""

import base64
import gzip
import hashlib
import re
import sys
from pathlib import Path
from urllib.parse import quote

HERE = Path(__file__).resolve().parent
NAME = "patchcord.html"
# The page itself, and what is in its text in another form.
INLINE = re.compile(r"index\.html|patchcord\.html|css/.*|js/theme\.js")


def element(path, text, attributes=""):
    """The element with a file. Nothing in its text may end it or begin another one."""
    if re.search(r"</?script|<!--", text, re.IGNORECASE):
        sys.exit(f"{path} cannot be in {NAME}: it contains <script or <!--")
    return f'<script type="text/plain" data-path="{path}"{attributes}>{text}</script>\n'


def compressed(path, content):
    """The element with a file that is no text."""
    text = base64.b64encode(gzip.compress(content, 9, mtime=0)).decode()
    return element(path, text, ' data-encoding="gzip-base64"')


def modules(site):
    """The paths of the modules. Each one comes after those that it imports."""
    order = []

    def add(path, importing):
        if path in importing:
            sys.exit(f"modules cannot import each other in {NAME}: {', '.join([*importing, path])}")
        if path not in order:
            for name in re.findall(r"\b(?:from|import) ?'\./([^']+)'", (site / path).read_text("utf-8")):
                add(f"js/{name}", [*importing, path])
            order.append(path)

    for path in sorted((site / "js").glob("*.js")):
        if path.name != "theme.js":
            add(f"js/{path.name}", [])
    return order


def files(site):
    """The elements with all files: the document of the host first, where `patchcord panel --export` puts a patch."""
    paths = sorted(path.relative_to(site).as_posix() for path in site.rglob("*") if path.is_file())
    others = [path for path in paths if not INLINE.fullmatch(path) and not path.startswith("js/")]
    others.sort(key=lambda path: path != "host.json")
    for path in [*others, *modules(site)]:
        content = (site / path).read_bytes()
        yield compressed(path, content) if path.endswith(".wasm") else element(path, content.decode("utf-8").strip())


def digest(text):
    """A text as the source of a policy."""
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"


def replaced(page, pattern, text):
    """The page with a text in the place of the only match of a pattern."""
    page, count = re.subn(pattern, lambda _: text, page)
    if count != 1:
        sys.exit(f"index.html must have {pattern} once, not {count} times")
    return page


def one_file(site):
    """The text of the page."""
    page = (site / "index.html").read_text("utf-8")
    links = r'(?:\s*<link rel="stylesheet" href="[^"]*">)+'
    styles = "".join((site / path).read_text("utf-8") for path in re.findall(r'rel="stylesheet" href="([^"]*)"', page))
    theme = (site / "js/theme.js").read_text("utf-8")
    start = (HERE / "one-file.js").read_text("utf-8")
    policy = (
        f"default-src 'none'; script-src {digest(theme)} {digest(start)} blob: 'wasm-unsafe-eval'; style-src {digest(styles)}; "
        "img-src data: blob:; worker-src data:; base-uri 'none'; form-action 'none'"
    )
    page = replaced(page, r'(?<=Content-Security-Policy" content=")[^"]*', policy)
    page = replaced(page, links, f"\n  <style>{styles}</style>")
    page = replaced(page, r'\s*<script type="module" src="js/main\.js"></script>', "")
    page = replaced(page, r'<script src="js/theme\.js">', f"<script>{theme}")
    icon = quote((site / "icon.svg").read_text("utf-8"))
    page = replaced(page, r'(?<=rel="icon" href=")icon\.svg', f"data:image/svg+xml,{icon}")
    return replaced(page, "</body>", f"{''.join(files(site))}<script>{start}</script>\n</body>")


def write(site):
    """Writes the page into the folder."""
    (site / NAME).write_text(one_file(site), "utf-8", newline="\n")
