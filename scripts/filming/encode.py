"""Films as files, by the writers of matplotlib: MP4 and WebM by ffmpeg, GIF by Pillow."""

import logging
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter

from filming.picture import DPI, Camera
from filming.take import FilmError

EXIT_OUTPUT = 4
CODECS = {
    ".mp4": ("libx264", "-preset medium -crf 18 -pix_fmt yuv420p -movflags +faststart"),
    ".webm": ("libvpx-vp9", "-crf 28 -b:v 0 -row-mt 1 -pix_fmt yuv420p"),
}
"""What ffmpeg is told for a kind of film."""
KINDS = (*CODECS, ".gif")
logging.getLogger("matplotlib.animation").setLevel(logging.ERROR)  # the message is given once


def check_means(path: Path) -> None:
    """Raise a FilmError unless films of this kind can be made."""
    if path.suffix not in KINDS:
        raise FilmError(
            f"{path}: the name of a film ends in {', '.join(KINDS[:-1])} or {KINDS[-1]}"
        )
    if path.suffix in CODECS and not shutil.which("ffmpeg"):
        raise FilmError(
            f"ffmpeg is not found, which makes {path.suffix} films; on Debian, as root:\n"
            "  apt-get install ffmpeg\n"
            f"A GIF needs nothing more: -o {path.with_suffix('.gif')}",
            EXIT_OUTPUT,
        )


def writer_of(kind: str, rate: int) -> AbstractMovieWriter:
    """What writes a kind of film."""
    if kind not in CODECS:
        return PillowWriter(fps=rate)
    codec, options = CODECS[kind]
    return FFMpegWriter(fps=rate, codec=codec, extra_args=options.split())


def write(path: Path, camera: Camera, rate: int) -> None:
    """Write a film, which takes its place when it is complete; the terminal tells how far it is."""
    total = len(camera.takes[0].rows)
    writer = writer_of(path.suffix, rate)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="film ", dir=path.parent) as folder:
            part = Path(folder) / path.name
            with writer.saving(camera.figure, str(part.absolute()), DPI):
                for i in range(total):
                    camera.show(i)
                    writer.grab_frame()
                    if sys.stderr.isatty():
                        end = "\n" if i + 1 == total else ""
                        print(f"\rpicture {i + 1} of {total}", end=end, file=sys.stderr, flush=True)
            part.replace(path)
    except subprocess.CalledProcessError as error:
        said = (error.stderr or error.output or "").strip()
        raise FilmError(f"ffmpeg failed: {said or error.returncode}", EXIT_OUTPUT) from error
    except OSError as error:
        raise FilmError(f"cannot write {path}: {error.strerror or error}", EXIT_OUTPUT) from error
