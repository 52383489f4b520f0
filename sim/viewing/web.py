"""A finished walk in MuJoCo's web viewer, served to this machine alone.

The server listens on the loopback interface unless another address is asked for; a
browser elsewhere comes through a tunnel. It answers those who have the address of the
page, in which there is a token.
"""

import logging
import socket
from collections.abc import Callable
from copy import copy
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING
from unittest.mock import patch

import mujoco

from models.description import fixed_to, root_body
from sim.errors import UsageError
from sim.folder import blamed_on
from sim.pictures.clock import Playback
from sim.runs.run import Run, read_run
from sim.viewing.access import Access, OwnSocket
from sim.viewing.marks import TORSO, Marks

if TYPE_CHECKING:
    from mujoco.studio.endpoints import ViewerEndpoint
    from mujoco.studio.viewer_handle import ViewerHandle

DISC, ARROW = 0.1, 0.04  # of a contact and its force, in units of the model's size
LOOPBACK = ("127.0.0.1", "::1", "localhost")
EVERYWHERE = ("0.0.0.0", "::", "")  # noqa: S104 (asked for by a person, and told)


def require_loopback(host: str, public: bool) -> None:
    """Refuse to serve the network unless that is wanted."""
    if host not in LOOPBACK and not public:
        raise UsageError.of("public", f"--host {host}")


def serve(
    folder: Path, host: str, port: int, speed: float, started: Callable[..., object]
) -> None:
    """Show a run until interrupted; `started` has its address, and one to use once."""
    with blamed_on(folder):
        walk = read_run(folder).in_world()
        model = looked_through(walk)
        playback = Playback(end=float(walk.time[-1]), speed=speed)
    bound, local = _bound(host, port), host in LOOPBACK
    access = Access(names=LOOPBACK if local else ())
    name = "localhost" if local else socket.gethostname()  # which browsers trust
    if not local and host not in EVERYWHERE:
        name = f"[{host}]" if ":" in host else host
    page = f"http://{name}:{bound.getsockname()[1]}/?token="
    begun = partial(started, *(page + t for t in (access.token, *access.tickets)))
    handle = _launch(walk, model, playback, bound, access, begun)
    with handle:
        handle.set_model(model)
        while handle.is_running():
            handle.sync()


def looked_through(walk: Run) -> mujoco.MjModel:
    """The model of a walk in few faces, its body transparent, its forces slender.

    Paths and support polygon lie under the body, and discs as wide as MuJoCo's own
    would cover the footprints.
    """
    model = copy(walk.model)
    walk.require_width(walk.ctrl, model.nu)
    model.geom_rgba[fixed_to(model, root_body(model, walk.model_file)), 3] *= TORSO
    quality = model.vis.quality  # in few faces, each of which costs time
    quality.numquads, quality.numslices, quality.numstacks = 1, 12, 6
    scale = model.vis.scale
    scale.contactwidth, scale.contactheight, scale.forcewidth = DISC, DISC / 4, ARROW
    return model


def _launch(
    walk: Run,
    model: mujoco.MjModel,
    playback: Playback,
    bound: socket.socket,
    access: Access,
    started: Callable[[], object],
) -> "ViewerHandle":
    """Start the viewer in a thread; its handle."""
    from mujoco.studio import launch_thread, ux, viewer_protocol, web_viewer
    from mujoco.studio.app import App
    from mujoco.studio.web import web_server

    from sim.viewing.plugins import Panel, Player, Scene

    logging.getLogger("WebServer").setLevel(logging.WARNING)
    for name in ("websockets", "asyncio"):  # browsers' errors are not the server's
        logging.getLogger(name).setLevel(logging.CRITICAL)
    config = viewer_protocol.ViewerConfig(title=walk.scenario.name, gfx="web")
    plugins = [App(), Scene(walk, Marks(walk, model)), Panel(walk, playback)]

    bind = web_server.bind_loopback_socket  # to which the viewer's own interface comes

    def own(port: int) -> OwnSocket:
        return OwnSocket(fileno=bind(port).detach())

    def show(endpoint: "ViewerEndpoint") -> None:
        # The viewer offers no choice of the interface that it listens on, of those who
        # are answered, nor silence; it keeps its layout in the person's home.
        with (
            patch.object(ux, "save_settings", lambda *_: None),
            patch.object(ux, "load_settings", lambda def_theme: def_theme),
            patch.object(ux, "reset_config", lambda *_: None),
            patch.object(web_server, "bind_public_socket", lambda *_: bound),
            patch.object(web_server, "bind_loopback_socket", own),
            patch.object(web_server, "serve", access.serve),
            patch.object(web_viewer, "_print_url_banner", lambda *_: None),
            patch.object(web_viewer, "print", lambda *_, **__: None, create=True),
        ):
            window = web_viewer.WebViewer(config, endpoint, plugins=plugins)
            draw = window.sync

            def first() -> None:  # what has not drawn yet bears no client
                draw()
                window.sync = draw
                started()

            window.sync = first
            viewer_protocol.run_viewer_loop(window)

    return launch_thread.launch_thread(show, sim_plugins=[Player(walk, playback)])


def _bound(host: str, port: int) -> socket.socket:
    from mujoco.studio.web import web_server

    try:
        bound = web_server.bind_public_socket(host, port)
        bound.listen()  # a browser may come before the server's thread does
        return bound
    except (OSError, RuntimeError) as error:
        raise UsageError.of("deaf", f"{host}:{port}") from error
