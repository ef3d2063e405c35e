"""The verbs of the command line, one file each: `add_arguments(parser)` and `run(arguments)`.

`run` returns nothing, or what there is to say of what it wrote.
"""
