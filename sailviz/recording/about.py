"""The words beside the picture: what it is, what to look for, where it comes from. Short, or the panel clips them."""

from __future__ import annotations

from sailviz.run import Setting

COLUMNS = 5  # of the table of parameters


def about(setting: Setting) -> str:
    """Markdown. A table of one row, since height is scarce and width is not."""
    lines = [f"### {setting.title}", "", setting.about.strip(), ""]
    lines += [f"- {hint.strip()}" for hint in setting.look_for]
    if setting.parameters:
        names, values = zip(*setting.parameters[:COLUMNS], strict=True)
        lines += ["", f"| {' | '.join(names)} |", "|---" * len(names) + "|", f"| {' | '.join(values)} |"]
    if setting.thesis:
        lines += ["", f"*Thesis, section {setting.thesis}*"]
    return "\n".join(lines)
