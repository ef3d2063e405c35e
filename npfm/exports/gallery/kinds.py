"""Kinds of files of a gallery: how they begin, so that nothing else is ever overwritten.

They are apart from what writes them, for a verb that declares all its outputs and makes one.
"""

from npfm.storage.files import Kind, marked

GENERATOR = '<meta name="generator" content="npfm gallery">'
PAGE = Kind("a page of the gallery", ".html", marked(GENERATOR.encode()))
TABLE_START = "npfmTable("
TABLE = Kind("a table of the gallery's demo", ".js", marked(TABLE_START.encode()))
FIGURE_START = "npfmFigure("
FIGURE = Kind("a figure of the gallery's demo", ".js", marked(FIGURE_START.encode()))
COMMENT = b"npfm gallery"
THUMBNAILS = Kind("small pictures of the gallery", ".jpg", marked(b"\xff\xd8", COMMENT))
