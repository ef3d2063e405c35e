"""The one exception that is meant for the user's eyes."""


class NpfmError(Exception):
    """A mistake in the input, told in one line: what is wrong, where, and what to do.

    The command line prints the message without a traceback and exits with code 1.
    """
