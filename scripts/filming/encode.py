"""Films as files: MP4 and WebM by ffmpeg, GIF by Pillow."""

import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

from PIL import Image

from filming.take import FilmError

EXIT_OUTPUT = 4
CODECS = {
    ".mp4": "-c:v libx264 -preset medium -crf 18 -pix_fmt yuv420p -movflags +faststart",
    ".webm": "-c:v libvpx-vp9 -crf 28 -b:v 0 -row-mt 1 -pix_fmt yuv420p",
}
"""What ffmpeg is told for a kind of film."""
KINDS = (*CODECS, ".gif")
COLOURS = 128
"""Of a GIF."""


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


def write(path: Path, pictures: Iterable[bytes], size: tuple[int, int], rate: int) -> None:
    """Write a film, which takes its place when it is complete."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="film ", dir=path.parent) as folder:
            part = Path(folder) / path.name
            if path.suffix == ".gif":
                write_gif(part, pictures, size, rate)
            else:
                write_by_ffmpeg(part, pictures, size, rate)
            part.replace(path)
    except OSError as error:
        raise FilmError(f"cannot write {path}: {error.strerror or error}", EXIT_OUTPUT) from error


def write_by_ffmpeg(
    path: Path, pictures: Iterable[bytes], size: tuple[int, int], rate: int
) -> None:
    """Hand the pictures to ffmpeg."""
    width, height = size
    taken = f"-loglevel error -f rawvideo -pix_fmt rgb24 -s {width}x{height} -r {rate} -i -"
    made = [*CODECS[path.suffix].split(), f"file:{path.absolute()}"]
    command = ["ffmpeg", *taken.split(), *made]
    with tempfile.TemporaryFile() as log:
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=log) as process:
            try:
                for picture in pictures:
                    process.stdin.write(picture)
                process.stdin.close()
            except BrokenPipeError:
                pass
            code = process.wait()
        if code:
            log.seek(0)
            text = log.read().decode(errors="replace").strip()
            raise FilmError(f"ffmpeg failed: {text or code}", EXIT_OUTPUT)


def write_gif(path: Path, pictures: Iterable[bytes], size: tuple[int, int], rate: int) -> None:
    """Write a GIF; all pictures have the colours of the first."""
    frames, palette = [], None
    for picture in pictures:
        image = Image.frombytes("RGB", size, picture)
        palette = palette or image.quantize(COLOURS)
        frames.append(image.quantize(palette=palette, dither=Image.Dither.NONE))
    time = round(100 / rate) * 10  # ms; a GIF counts in hundredths of a second
    frames[0].save(
        path, save_all=True, append_images=frames[1:], duration=time, loop=0, optimize=False
    )
