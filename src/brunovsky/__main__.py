"""``python -m brunovsky`` is the ``brunovsky`` command."""

from brunovsky.cli import main

main()
