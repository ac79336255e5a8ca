"""Groups whose commands stand in more than one file."""

import typer

log = typer.Typer(help="Record, inspect, replay and convert logs.", no_args_is_help=True)
identify = typer.Typer(
    help="Identify the arm: its joints by hand, its parameters from recorded runs.",
    no_args_is_help=True,
)
export = typer.Typer(
    help="Give an arm to other programs: files, services, ROS 2.", no_args_is_help=True
)
