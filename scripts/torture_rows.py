"""Inputs and faults for `scripts/torture.py`: what is run, and how it must end."""

from __future__ import annotations

from scripts.torture_inputs import (
    BOMBS,
    CARD,
    FFMPEG_THAT_DIES,
    FILM_IN_A_THREAD,
    GO,
    HEXAPOD,
    MANY_FILMS,
    NAN_COMMAND,
    ROOT,
    STOP,
    Row,
    both,
    file,
    inside,
    link,
    reordered,
    robot,
    text_of,
    world,
)  # fmt: skip
from scripts.torture_sweeps import SWEEPS, VIEWERS

__all__ = ["ROOT", "ROWS", "Row"]

SHORT = "--no-video --segments 4 --set path.goal=[0.02,0.02,0]"
WILD = "--set timestep=0.01 --set servo_stiffness=1e6 --set servo_damping=0"
SYSTEM = 'state = ["x", "y", "z"]\ngoal = { z = 1 }\n[strata.0]\nf = { x = 1 }\n'
PATHS = "test_curves.py::test_impossible_curves_are_refused"
SAME = "&& cmp a/commands.npz b/commands.npz && cmp a/trajectory.npz b/trajectory.npz"
VALUES = "test_scenario.py::test_impossible_value_is_refused_with_key_value_and_limits"
OUTSIDE = (
    "test_inspection.py::test_a_model_opens_nothing_outside_its_folder_unless_it_may"
)
BAD = "test_cli.py::test_unusable_robot_file_is_a_bad_model"
REFUSED = "test_cli.py::test_refusal_is_one_line_and_a_code"

SCENARIOS = (
    Row(1, "a scenario that is missing", "stratawalk run gone.toml", 2, REFUSED),
    Row(
        1, "an empty scenario", "stratawalk run mine.toml", 2,
        "test_scenario.py::test_file_must_say_what_has_no_default",
        file("mine.toml", ""),
    ),
    Row(1, "a folder for a scenario", "stratawalk run .", 2, REFUSED),
    Row(2, "an unknown key", "stratawalk run line --set fricton=1", 2, REFUSED,
        says="did you mean 'friction'?"),
    Row(3, "friction that is no number", "stratawalk run line --set friction=nan", 2,
        VALUES),
    Row(3, "a gain without end", "stratawalk run line --set servo_stiffness=inf", 2,
        VALUES),
    Row(4, "a timestep of 0", "stratawalk run line --set timestep=0", 2, REFUSED),
    Row(4, "a timestep that overflows", "stratawalk run line --set timestep=1e-320", 2,
        "test_faults.py::test_a_timestep_that_no_walk_would_survive_is_refused"),
    Row(4, "a timestep too long", f"stratawalk run line {GO} --set timestep=0.004", 2,
        "test_told.py::test_settings_under_which_nothing_can_stand_are_named"),
    Row(5, "strokes beyond the range", "stratawalk plan line --segments 1", 4, REFUSED),
    Row(5, "a leg of no length", "stratawalk robots mine.xml", 3,
        "test_refused_robots.py::test_an_unusable_robot_is_refused_by_its_reason",
        robot('range="-0.45 0.45"', 'range="0 0"')),
    Row(6, "a path of no points", "stratawalk plan mine.toml", 2, PATHS,
        file("mine.toml", '[path]\nkind = "table"\nposes = []')),
    Row(6, "a path of one point", "stratawalk plan mine.toml", 2, PATHS,
        file("mine.toml", '[path]\nkind = "table"\nposes = [[0, 0, 0]]')),
    Row(6, "a path with a NaN", "stratawalk plan mine.toml", 2,
        "test_curves.py::test_impossible_files_are_refused",
        both(file("mine.toml", '[path]\nkind = "table"\nfile = "a.csv"'),
             file("a.csv", "x,y,yaw\n0,0,0\n0.1,nan,0\n"))),
    Row(6, "a path of a million points", "stratawalk plan mine.toml", 2,
        "test_curves.py::test_impossible_files_are_refused",
        both(file("mine.toml", 'segments = 4\n[path]\nkind = "table"\nfile = "a.csv"'),
             text_of("a.csv", "x,y,yaw\n0,0,0\n",
                     (f"{0.02 * i / 1e6!r},0,0\n" for i in range(1, 10**6))))),
    Row(7, "no way to go",
        "stratawalk run line --no-video --segments 1 --set path.goal=[0,0,0]", 0,
        "test_run_folder.py::"
        "test_a_path_of_no_length_walks_nowhere_and_divides_by_nothing"),
    Row(8, "a goal that no motion leads to", "stratawalk plan mine.toml", 4,
        "test_systems.py::test_refusal_is_one_line_and_a_code",
        file("mine.toml", SYSTEM), says="rank 1 of 3"),
    Row(8, "too little time", "stratawalk plan corridor --set plan_time=1e-3", 4,
        "test_plan_time.py::test_a_plan_that_takes_too_long_is_refused"),
    Row(8, "segments without number, to a goal beyond reach",
        "stratawalk plan line --segments 100000 --set path.goal=[1e6,0,0]", 2,
        "test_effort.py::test_a_path_that_no_walk_follows_is_refused_before_planning"),
)  # fmt: skip

MODELS = (
    Row(9, "MJCF that is none", "stratawalk robots mine.xml", 3, BAD,
        file("mine.xml", "<mujoco")),
    Row(9, "an empty file for MJCF", "stratawalk robots mine.xml", 3, BAD,
        file("mine.xml", "")),
    Row(9, "bytes for MJCF", "stratawalk robots mine.xml", 3, BAD,
        file("mine.xml", b"\x00\x01\xff")),
    Row(9, "MJCF in UTF-16", "stratawalk robots mine.xml", 3, BAD,
        file("mine.xml", HEXAPOD.encode("utf-16"))),
    Row(10, "a mass that is none", "stratawalk robots mine.xml", 3,
        "test_numbers.py::test_text_with_a_number_that_is_none_is_refused",
        robot('mass="1"', 'mass="nan"')),
    Row(10, "gravity that is none", "stratawalk robots mine.xml", 3,
        "test_numbers.py::test_text_with_a_number_that_is_none_is_refused",
        world('<option gravity="0 0 nan"/>')),
    Row(10, "a size without end", "stratawalk robots mine.xml", 3,
        "test_numbers.py::test_text_with_a_number_that_is_none_is_refused",
        inside('<geom size="inf" pos="0 0 9"/>')),
    Row(11, "entities that grow", "stratawalk robots mine.xml", 0,
        "test_strangers.py::test_entities_are_never_expanded",
        robot("<mujoco", BOMBS["entities"] + "<mujoco")),
    Row(12, "a texture of somebody else's", "stratawalk robots mine.xml", 3, OUTSIDE,
        world('<compiler discardvisual="true"/><asset>'
              '<texture type="2d" name="t" file="/etc/hostname"/></asset>')),
    Row(12, "an include above its folder", "stratawalk robots mine.xml", 3, OUTSIDE,
        both(world('<include file="../more.xml"/>'),
             file("../more.xml", "<mujoco><worldbody/></mujoco>"))),
    Row(12, "a link out of its folder", "stratawalk robots mine.xml", 3, OUTSIDE,
        both(world('<asset><hfield name="h" file="h.png" size="1 1 1 1"/></asset>'),
             link("h.png", "/etc/hostname"))),
    Row(12, "the same, trusted", "stratawalk robots mine.xml --allow-external", 0,
        OUTSIDE, both(world('<include file="../more.xml"/>'),
                      file("../more.xml", "<mujoco><worldbody/></mujoco>")), lines=1),
    Row(13, "an include of itself", "stratawalk robots mine.xml", 3,
        "test_strangers.py::test_what_a_stranger_sends_is_refused_in_time",
        world('<include file="mine.xml"/>')),
    Row(13, "a missing include", "stratawalk robots mine.xml", 3,
        "test_strangers.py::test_what_a_stranger_sends_is_refused_in_time",
        world('<include file="no.xml"/>')),
    Row(13, "a missing mesh", "stratawalk robots mine.xml", 3,
        "test_inspection.py::test_a_file_that_is_missing_is_named",
        world('<asset><mesh name="m" file="no.stl"/></asset>')),
    *(Row(14, f"a model of {name}", "stratawalk robots mine.xml", 3,
          "test_inspection.py::test_a_model_that_grows_without_end_is_refused_in_time",
          inside(BOMBS[name]) if name in ("300,000 copies", "a fine block")
          else world(BOMBS[name]), says="too large")
      for name in ("300,000 copies", "a fine block", "a fine height field",
                   "a fine texture")),
    Row(15, "ten thousand geoms", "stratawalk robots mine.xml", 0,
        "test_strangers.py::test_a_model_that_is_merely_large_is_read",
        inside("".join(f'<geom size=".001" pos="0 {i} 9" contype="0" conaffinity="0"/>'
                       for i in range(10_000)))),
    Row(16, "a missing joint", "stratawalk robots mine.xml", 3,
        "test_refused_cards.py::test_an_impossible_card_is_refused_by_its_reason",
        robot('= "swing_1"', '= "hip"'), says="joint 'hip'"),
    Row(16, "an engine without memory", "stratawalk robots mine.xml", 3,
        "test_faults.py::test_an_engine_without_room_is_a_bad_model",
        world('<size memory="20K"/>')),
    Row(17, "joints in another order",
        f"stratawalk run line {GO} --robot mine.xml", 0,
        "test_strangers.py::test_joints_are_known_by_their_names",
        reordered),
    Row(18, "a truncated MJB for MJCF", "stratawalk robots mine.xml", 3, BAD,
        file("mine.xml", b"\x00\x01\x02\x03MJB" + bytes(200))),
    Row(18, "an MJB by its name", "stratawalk robots mine.mjb", 2, REFUSED,
        file("mine.mjb", bytes(200))),
    *(Row(19, f"an STL {name}", "stratawalk robots mine.xml", 3,
          "test_strangers.py::test_what_a_stranger_sends_is_refused_in_time",
          both(world('<asset><mesh name="m" file="m.stl"/></asset>'),
               file("m.stl", content)))
      for name, content in (
          ("that is truncated", bytes(80) + b"\x04\x00\x00\x00" + bytes(20)),
          ("of four billion faces", bytes(80) + b"\xff" * 4 + bytes(50)),
          ("that is flat", bytes(80) + b"\x01\x00\x00\x00" + bytes(50)),
          ("of NaN", bytes(80) + b"\x01\x00\x00\x00"
           + b"\x00\x00\xc0\x7f" * 12 + b"00"),
      )),
    Row(9, "a card of 1e308", "stratawalk robots mine.xml", 3,
        "test_faults.py::test_a_gain_that_overflows_is_a_bad_card",
        both(robot("", ""), file("mine.toml", CARD.replace("{ 1 = -1,",
                                                           "{ 1 = 1e308,")))),
)  # fmt: skip

WALKS = (
    Row(20, "a walk that diverges", f"stratawalk run line {GO} {WILD}", 4,
        "test_told.py::"
        "test_a_divergence_leaves_what_led_to_it_and_says_how_to_see_it_again",
        says="warning BADQACC"),
    Row(20, "servos too soft", f"stratawalk run line {GO} --set servo_stiffness=1e-9",
        3, "test_told.py::test_settings_under_which_nothing_can_stand_are_named"),
    Row(21, "a command that is no number", "python nan.py", 4,
        "test_engine.py::test_a_command_that_is_not_finite_is_stopped_before_the_engine",
        file("nan.py", NAN_COMMAND), says="is nan"),
    Row(22, "a start in the air", "stratawalk robots mine.xml", 0,
        "test_told.py::test_a_robot_that_is_moved_at_its_start_is_told",
        robot("0 0 0.06 1", "0 0 0.5 1"), says="let down onto the floor"),
    Row(22, "a start in the ground", "stratawalk robots mine.xml", 0,
        "test_told.py::test_a_robot_that_is_moved_at_its_start_is_told",
        robot("0 0 0.06 1", "0 0 0.03 1"), says="lifted out of the floor"),
    Row(22, "a start upside down", "stratawalk robots mine.xml", 3,
        "test_refused_robots.py::test_an_unusable_robot_is_refused_by_its_reason",
        robot("0.06 1 0", "0.3 0 1")),
    Row(22, "zeros for a quaternion", "stratawalk robots mine.xml", 3,
        "test_told.py::test_a_quaternion_of_zeros_is_no_way_to_stand",
        robot("0.06 1", "0.06 0")),
)  # fmt: skip

SURROUNDINGS = (
    Row(29, "Ctrl-C during a walk",
        f"{STOP} INT 15 stratawalk run line --no-video --segments 400", 130,
        "test_cli.py::test_signal_ends_a_run_with_one_line_and_whole_files"),
    Row(29, "Ctrl-C during planning", f"{STOP} INT 12 stratawalk plan corridor", 130,
        "test_interruption.py::"
        "test_a_long_step_of_a_library_is_ended_with_the_best_so_far"),
    Row(29, "Ctrl-C twice", f"{STOP} INT 15 sh twice.sh", 130,
        "test_interruption.py::test_a_second_signal_ends_at_once",
        file("twice.sh", "stratawalk run line --no-video --segments 400 & "
             "trap 'kill -INT $!; kill -INT $!' INT; wait; wait; exit 130")),
    Row(30, "SIGTERM during a walk",
        f"{STOP} TERM 15 stratawalk run line --no-video --segments 400", 143,
        "test_cli.py::test_signal_ends_a_run_with_one_line_and_whole_files"),
    Row(31, "a full disk", "unshare -rm sh -c 'mount -t tmpfs -o size=60k t out && "
        f"stratawalk run line {GO} --out out/a'", 6,
        "test_folder.py::test_disk_that_fills_up_halfway_leaves_no_file",
        lambda folder: (folder / "out").mkdir(), says="disk full, it needs"),
    Row(31, "a full disk under the output",
        "stratawalk plan biped --json >/dev/full", 6,
        "test_faults.py::test_a_full_disk_under_the_output_is_a_fault_of_files"),
    Row(31, "a full disk under standard error", "stratawalk plan gone 2>/dev/full", 2,
        "test_faults.py::test_a_full_disk_under_standard_error_leaves_the_code",
        lines=0),
    Row(32, "a run folder that cannot be", f"stratawalk run line {GO} --out /proc/run",
        6, REFUSED),
    Row(32, "a file for its parent", f"stratawalk run line {GO} --out a/b", 6,
        "test_folder.py::test_folder_below_a_file_is_refused", file("a", "")),
    Row(32, "a name of blanks and more",
        f"stratawalk run line {GO} --out 'ö x'/a >/dev/null", 0,
        "test_folder.py::test_any_name_of_a_folder_will_do"),
    Row(33, "a run folder that exists", f"stratawalk run line {GO} --out .", 2,
        REFUSED),
    Row(33, "a plan that exists", "stratawalk plan biped --save a.json", 2,
        "test_faults.py::test_a_plan_is_never_saved_over_another", file("a.json", "")),
    Row(34, "no driver, and a film", "MUJOCO_GL=disabled stratawalk run line --video",
        5, "test_cli.py::test_film_that_cannot_be_drawn_is_refused_before_the_walk"),
    Row(34, "no driver, and no word of a film",
        "MUJOCO_GL=disabled stratawalk run line --segments 1 "
        "--set path.goal=[0.005,0,0]", 0,
        "test_cli.py::test_run_without_a_driver_warns_in_one_line_and_walks", lines=1),
    Row(34, "a driver that is none", f"MUJOCO_GL=banana stratawalk run line {GO}", 0,
        "test_cli.py::test_physics_runs_whatever_mujoco_gl_says"),
    Row(35, "pictures of another size", "stratawalk film . --size 641x481", 2,
        "test_cli.py::test_refusal_is_one_line_and_a_code"),
    Row(36, "no ffmpeg",
        "IMAGEIO_FFMPEG_EXE=/none stratawalk run line --video", 5,
        "test_failures.py::test_an_encoder_that_will_not_do_is_refused_beforehand"),
    Row(36, "an ffmpeg that fails",
        "IMAGEIO_FFMPEG_EXE=/bin/false stratawalk run line --video", 5,
        "test_failures.py::test_an_encoder_that_will_not_do_is_refused_beforehand"),
    Row(37, "an ffmpeg that dies while filming",
        f"stratawalk run line {GO} --out a >/dev/null && "
        "IMAGEIO_FFMPEG_EXE=./ffmpeg stratawalk film a", 5,
        "test_failures.py::test_an_encoder_that_fails_leaves_no_film",
        file("ffmpeg", FFMPEG_THAT_DIES)),
    Row(37, "a film of a damaged run",
        f"stratawalk run line {GO} --out a >/dev/null && head -c 2000 "
        "a/trajectory.npz >b && mv b a/trajectory.npz && stratawalk film a", 2,
        "test_damaged_runs.py::test_a_damaged_run_is_refused_in_one_line"),
    Row(38, "a film drawn from another thread", "python thread.py", 0,
        "test_many_films.py::test_a_film_may_be_drawn_from_any_thread",
        file("thread.py", FILM_IN_A_THREAD)),
    Row(39, "films one after another", "python films.py", 0,
        "test_many_films.py::test_films_one_after_another_take_no_more_memory",
        file("films.py", MANY_FILMS)),
    Row(40, "the same run twice",
        f"stratawalk run line {SHORT} --out a && OMP_NUM_THREADS=1 taskset -c 0 "
        f"stratawalk run line {SHORT} --out b {SAME}", 0,
        "test_golden.py::test_a_walk_has_the_bytes_that_it_always_had"),
    Row(41, "other surroundings",
        f"stratawalk run line {SHORT} --out a && env -u HOME LC_ALL=de_DE.UTF-8 "
        f"TZ=Asia/Tokyo PYTHONHASHSEED=7 stratawalk run line {SHORT} --out b {SAME}",
        0, "test_surroundings.py::test_bytes_do_not_depend_on_surroundings"),
    Row(42, "a reader that has seen enough", "stratawalk scenarios line | head -1", 0,
        "test_reader.py::test_a_reader_that_has_seen_enough_is_no_error"),
    Row(45, "no friction", f"stratawalk run line {GO} --set friction=0", 0,
        "test_surroundings.py::test_a_floor_without_friction_is_walked_on"),
    Row(45, "friction below zero", "stratawalk run line --set friction=-1", 2, VALUES),
)  # fmt: skip

PYTHON = (
    Row(2, "a system that exits", "stratawalk check mine.py", 2,
        "test_faults.py::test_a_python_system_may_end_as_it_likes",
        file("mine.py", "raise SystemExit")),
    Row(2, "an error in a system", "stratawalk check mine.py", 2,
        "test_faults.py::test_a_python_system_may_end_as_it_likes",
        file("mine.py", "1 / 0")),
)  # fmt: skip

ROWS = tuple(
    sorted(
        (*SCENARIOS, *MODELS, *WALKS, *SWEEPS, *SURROUNDINGS, *VIEWERS, *PYTHON),
        key=lambda row: row.number,
    )
)
