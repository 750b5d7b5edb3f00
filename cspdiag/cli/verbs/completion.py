"""``cspdiag completion``: what a shell needs to complete command lines."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from cspdiag.cli.support.failure import FINE, needed_packages
from cspdiag.cli.support.terminal import write_out

EXAMPLE = (
    'eval "$(cspdiag completion bash)"            # in ~/.bashrc\n'
    'eval "$(cspdiag completion zsh)"             # in ~/.zshrc, after compinit\n'
    "cspdiag completion fish | source             # in ~/.config/fish/config.fish"
)

SHELLS = ("bash", "zsh", "fish")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("shell", choices=SHELLS, help="the shell")


def run(arguments: Namespace) -> int:
    """Print the commands."""
    with needed_packages("completion", "argcomplete"):
        from argcomplete.shell_integration import shellcode
    write_out(shellcode(["cspdiag"], shell=arguments.shell).lstrip())
    return FINE
