"""The verbs of the command line: each returns an `Outcome`; nothing here prints or exits."""
