"""The documentation as web pages: theory, how-to, flows, columns, gallery and the reference of all modules.

    python -m stability.docs

writes them into `build/docs` (needs `pip install '.[docs]'`, and the figures of the repository). Warnings are errors,
and so are links that lead nowhere.
"""
