"""The commands of `ngdgc`: arguments, files, progress, signals.

Here: what only the command line needs.
Not here: what a script would call too; commands import it when they run.
"""
