"""What is done to the built pages: NGSolve's viewer is stored once for all scenes, sliders become pictures."""

import html
import json
import re
import shutil
from hashlib import sha256

VIEWER = 100_000        # characters: a script as long as this is the viewer, the data of a scene come in another
SLIDERS = "The sliders move in the notebook itself; this is what they start from."
SCENE = re.compile(r'srcdoc="([^"]*)"')
STATE = re.compile(r'<script type="application/vnd.jupyter.widget-state\+json">(.*?)</script>', re.S)
VIEW = re.compile(r'<script type="application/vnd.jupyter.widget-view\+json">(.*?)</script>', re.S)


def CopyMathJax(source, target):
    """Copy the part of MathJax that the pages use, which loads nothing from a network: one script and its fonts."""
    target.mkdir(parents=True, exist_ok=True)
    shutil.copy(source / "tex-chtml.js", target)
    shutil.copytree(source / "output" / "chtml" / "fonts", target / "output" / "chtml" / "fonts", dirs_exist_ok=True)


def Finish(outdir, gallery):
    """Copy the scenes of the gallery, and rewrite all pages of the build."""
    for scene in sorted(gallery.glob("*.html")):
        Store(scene.read_text(encoding="utf-8"), outdir / "gallery" / scene.name, outdir)
    for page in sorted(outdir.rglob("*.html")):
        text = page.read_text(encoding="utf-8")
        if "srcdoc=" in text or "vnd.jupyter.widget" in text:
            page.write_text(StaticWidgets(SharedScenes(text, page, outdir)), encoding="utf-8")


def Store(scene, path, outdir):
    """Write a scene, a whole page of HTML, to `path`, its viewer to _static/ under the name of its content."""
    path.parent.mkdir(parents=True, exist_ok=True)
    up = "../" * (len(path.relative_to(outdir).parts) - 1)
    start = scene.find("<script>") + len("<script>")
    end = scene.find("</script>", start)
    if end - start > VIEWER:
        code = scene[start:end]
        viewer = outdir / "_static" / f"viewer-{sha256(code.encode()).hexdigest()[:12]}.js"
        if not viewer.exists():
            viewer.parent.mkdir(exist_ok=True)
            viewer.write_text(code, encoding="utf-8")
        scene = f'{scene[:start - 1]} src="{up}_static/{viewer.name}">{scene[end:]}'
    path.write_text(scene, encoding="utf-8")


def SharedScenes(text, page, outdir):
    """The page with every scene that it holds as srcdoc moved to a file of its own in scenes/."""
    up = "../" * (len(page.relative_to(outdir).parts) - 1)

    def Move(match):
        scene = html.unescape(match[1])
        name = f"scenes/{sha256(scene.encode()).hexdigest()[:12]}.html"
        Store(scene, outdir / name, outdir)
        return f'src="{up}{name}"'
    return SCENE.sub(Move, text)


def StaticWidgets(text):
    """The page with widgets, which live only with a kernel, replaced by the pictures and texts they showed."""
    found = STATE.search(text)
    models = json.loads(found[1])["state"] if found else {}

    def Show(match):
        shown = "".join(_Outputs(json.loads(match[1])["model_id"], models))
        return f'<div class="admonition note"><p>{SLIDERS}</p>{shown}</div>'
    return STATE.sub("", VIEW.sub(Show, text))


def _Outputs(name, models):
    """HTML of all outputs of a widget and its children, depth first."""
    state = models.get(name, {}).get("state", {})
    for output in state.get("outputs", ()):
        shown = output.get("data", {})
        if "image/png" in shown:
            yield f'<img alt="what the sliders show" src="data:image/png;base64,{shown["image/png"].strip()}">'
        elif "text/html" in shown:
            yield shown["text/html"]
        else:
            yield f"<pre>{html.escape(shown.get('text/plain', output.get('text', '')))}</pre>"
    for child in state.get("children", ()):
        yield from _Outputs(child.removeprefix("IPY_MODEL_"), models)
