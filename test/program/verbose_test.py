"""A run prints what a person reads; the rest with --verbose."""

from conftest import CLOSED, Spin, each

MOST = 10
EVENTS = "&output columns = 't', 'theta' events = 'turning_points' /\n"
SWEEP = "&study kind = 'sweep' /\n&sweep parameter = 'top.mass' from = 1 to = 9 count = 5 /\n"


@each(
    "text, details",
    (CLOSED + EVENTS, ("model", "constants", "fast top", "cost")),
    (CLOSED + "&integration method = 'dop853' /\n", ("model", "constants", "fast top", "cost")),
    (CLOSED + SWEEP, ("model", "ended", "parts", "memory")),
    ids=["trajectory", "integrated", "sweep"],
)
def test_details(spin: Spin, text: str, details: tuple[str, ...]) -> None:
    """The lines of a run are few, and all of them are among those of --verbose."""
    short = spin(text).out.splitlines()
    whole = spin(text, "-v").out.splitlines()
    assert len(short) <= MOST
    assert [words(line) for line in short] == [
        words(line) for line in whole if not line.strip().startswith(details)
    ]
    assert all(any(line.startswith(f"  {word}") for line in whole) for word in details)
    if "sweep" in text:
        log = (spin.folder / "output/scene.log").read_text(encoding="utf-8").splitlines()
        assert [words(line) for line in log] == [words(line) for line in whole]


def words(line: str) -> str:
    """The keyword of a line, and its text unless this is a time."""
    is_timed = line.startswith(("  time", "  ended", "  parts", "  memory", "  cost"))
    return line[:12] if is_timed else line
