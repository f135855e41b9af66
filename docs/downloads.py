"""What pages offer as files: a notebook is read here and run elsewhere."""

import json


def Offered(source, file):
    """The source of a notebook, JSON, with a link to its file below the title of its first cell.

    >>> print(json.loads(Offered('{"cells": [{"source": ["# Title"]}]}', "a.ipynb"))["cells"][0]["source"].strip())
    # Title
    <BLANKLINE>
    {download}`Download this notebook <a.ipynb>`
    """
    notebook = json.loads(source)
    title, _, rest = "".join(notebook["cells"][0]["source"]).partition("\n")
    notebook["cells"][0]["source"] = f"{title}\n\n{{download}}`Download this notebook <{file}>`\n\n{rest.lstrip()}"
    return json.dumps(notebook)
