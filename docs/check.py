"""Check a built site: `python docs/check.py results/docs`; pictures of every page go beside it, to results/docs-screens.

Every link and resource must lead to a file, and its #name to a place in it; nothing may be loaded from a network; every page is
opened in headless Chromium, wide and narrow, must say no error on the console, and is photographed.  Exit code 1 otherwise.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

WIDTHS = {"wide": 1280, "narrow": 400}
HEIGHT = 2400
RESOURCES = {"script": "src", "img": "src", "iframe": "src", "link": "href", "source": "src", "video": "src"}
NETWORK = re.compile(r"""url\(\s*['"]?(?:https?:)?//|@import\s+['"](?:https?:)?//""")
CHROMIUM = ("chromium", "chromium-browser", "google-chrome")
# No network; WebGL in software, which draws the scenes.
OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--hide-scrollbars",
           "--enable-unsafe-swiftshader", "--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=8000",
           "--enable-logging=stderr", "--v=0")
# A line of the console: level, text, source.  The viewer says what it does, as information.
CONSOLE = re.compile(r":(INFO|WARNING|ERROR):CONSOLE.*?\] \"(.*)\", source: (.*)")
WRONG = re.compile(r"error|uncaught|failed to load|not allowed|refused|exception", re.I)


class Page(HTMLParser):
    """`names` to which links may lead, `links` of readers, and `resources` that are loaded."""

    def __init__(self, path):
        super().__init__()
        self.names, self.links, self.resources = set(), [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.names |= {found[key] for key in ("id", "name") if found.get(key)}
        if tag == "a" and found.get("href"):
            self.links.append(found["href"])
        if found.get(RESOURCES.get(tag)) and found.get("rel") not in ("canonical", "next", "prev"):
            self.resources.append(found[RESOURCES[tag]])


def Problems(site):
    """Lines about links and resources of all pages that lead nowhere or into a network."""
    pages = {path: Page(path) for path in sorted(site.rglob("*.html"))}
    for path, page in pages.items():
        name = path.relative_to(site)
        for kind, targets in (("link", page.links), ("resource", page.resources)):
            for target in targets:
                parts = urlsplit(target)
                if parts.scheme in ("http", "https") or parts.netloc:
                    if kind == "resource":
                        yield f"{name}: loads {target} from a network"
                elif parts.scheme not in ("data", "mailto", "javascript"):
                    found = (path.parent / unquote(parts.path)).resolve() if parts.path else path
                    if not found.is_file():
                        yield f"{name}: {kind} {target} leads nowhere"
                    elif kind == "link" and parts.fragment and unquote(parts.fragment) not in pages[found].names:
                        yield f"{name}: {target} leads to no place in its page"
    for path in site.rglob("*.css"):
        if NETWORK.search(path.read_text(encoding="utf-8")):
            yield f"{path.relative_to(site)}: loads from a network"


def Errors(log):
    """Errors among the lines that Chromium wrote.

    >>> Errors('[1:1:INFO:CONSOLE:2] "Webgui - initCanvas", source: a.js (2)')
    []
    """
    found = CONSOLE.findall(log)
    return [f"{text} ({source})" for level, text, source in found if level == "ERROR" or WRONG.search(text)]


def Open(chromium, path, site, screens, label):
    """Photograph a page at a width; lines about errors on its console."""
    name = str(path.relative_to(site).with_suffix("")).replace("/", "-")
    picture = screens / f"{name}-{label}.png"
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run([chromium, *OPTIONS, f"--user-data-dir={profile}", f"--window-size={WIDTHS[label]},{HEIGHT}",
                               f"--screenshot={picture}", path.resolve().as_uri()], capture_output=True, text=True, timeout=180)
    errors = [f"{path.relative_to(site)} ({label}): {error}" for error in Errors(done.stderr)]
    return errors if picture.exists() else [*errors, f"{path.relative_to(site)} ({label}): no picture"]


def Main(site):
    """Check the site; the number of problems."""
    site = Path(site).resolve()
    problems = list(Problems(site))
    pages = sorted(site.rglob("*.html"))
    chromium = next(filter(None, map(shutil.which, CHROMIUM)), None)
    if chromium:
        screens = site.with_name(f"{site.name}-screens")
        screens.mkdir(exist_ok=True)
        with ThreadPoolExecutor(2) as pool:
            for found in pool.map(lambda task: Open(chromium, task[0], site, screens, task[1]),
                                  [(path, label) for path in pages for label in WIDTHS]):
                problems += found
        print(f"{len(pages)} pages opened, pictures in {screens.name}/")
    else:
        print("no Chromium here: pages were not opened")
    for problem, count in Counter(problems).items():
        print(problem + (f" ({count} times)" if count > 1 else ""))
    print(f"{len(pages)} pages, {len(problems)} problems")
    return len(problems)


if __name__ == "__main__":
    sys.exit(Main(sys.argv[1]) > 0)
