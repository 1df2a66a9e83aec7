"""What the command measures, plans and fits: info, requirements, predict, fit, profiles.

Answers have the keys of the command's JSON (docs/cli.md) as fields. Scenes and tables may be in
memory; they go through a folder that is gone afterwards.
"""

from array import array as _array
from math import nan as _nan


class Answer:
    """What a call has found: fields by the names of docs/cli.md, `vars(answer)` as a dict. What is
    not finite is None."""

    def __init__(self, fields):
        self.__dict__.update({name: self._value(value) for name, value in fields.items()})

    @classmethod
    def _value(cls, value):
        if isinstance(value, dict):
            return Answer(value)
        if isinstance(value, list):
            return [cls._value(one) for one in value]
        return value

    def __repr__(self):
        shown = ", ".join(f"{name}={_short(value)}" for name, value in vars(self).items())
        return f"<lariat.{type(self).__name__} {shown}>"

    def __eq__(self, other):
        return type(self) is type(other) and vars(self) == vars(other)

    __hash__ = None


def _short(value):
    if isinstance(value, (list, _array)) and len(value) > 3:
        return f"[{len(value)}]"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


class _Field:
    """What a field is, for help(); its value is the instance's own."""

    def __init__(self, doc):
        self.__doc__ = doc

    def __set_name__(self, owner, name):
        self.name = name

    def __get__(self, instance, owner=None):
        if instance is None:
            return self
        raise AttributeError(f"{type(instance).__name__} has no {self.name} here")


class Parameter(Answer):
    """A parameter of tissue that `fit` has found: value, and low and high, where 95 % lie."""

    material = _Field("str: name of the material that has it.")
    parameter = _Field("str: its name, as in scenes.")
    unit = _Field('str: of value, low, high, guess and the bounds: "Pa", "s", "".')
    value = _Field("float: with which the simulations answer best.")
    low = _Field("float: 95 % lie from here; nan: not known, as at a bound, or interrupted.")
    high = _Field("float: to here.")
    guess = _Field("float: where the fit began.")
    lower_bound = _Field("float: it is not looked for below.")
    upper_bound = _Field("float: nor above.")
    told = _Field("bool: the data say what it is; False: from low to high all fits, or at_bound.")
    at_bound = _Field("bool: it stands at a bound and the data ask for a value beyond: widen it.")
    given_bound = _Field("bool: another one does; low and high are for that bound as a known number.")
    profiled = _Field("bool: the interval is by its profile, not by the curvature alone.")
    sensitivity = _Field("float: by how many times the noise the data change when it grows e times.")
    correlation = _Field("array of float64 [parameters]: with each of the fit, in their order.")
    tissue = _Field("str: path of its material's tissue file, for scenes and lariat.mesh; None without `out`.")

    def __init__(self, fields):
        super().__init__(fields)
        for name in ("value", "low", "high", "sensitivity"):
            if getattr(self, name) is None:
                setattr(self, name, _nan)
        self.correlation = _floats(self.correlation)
        self.tissue = None


class Experiment(Answer):
    """An experiment of a `fit`, and how well the model answers as the tissue did."""

    name = _Field("str: for messages and pictures.")
    kind = _Field('str: "tension", "compression", "indentation", "aspiration", "markers", "surface".')
    scene = _Field("str: path of the scene.")
    data = _Field("str: path of the table.")
    in_time = _Field("bool: followed in time; False: from rest to rest.")
    values = _Field("int: how many numbers were measured.")
    noise = _Field("float: standard deviation of a measured number [N or m].")
    rms = _Field("float: root mean square of what is left [N or m].")
    relative = _Field("float: rms by the largest that was measured; surfaces: by the body's length.")
    sign_runs = _Field("int: how often what is left changes its sign, plus 1.")
    sign_runs_z = _Field("float: the same against chance; None: cannot be told.")
    lag = _Field("float: correlation of what is left of neighbours; None: cannot be told.")
    systematic = _Field("bool: what is left is no chance.")
    measured = _Field("array of float64 [values]: forces [N], or lengths [m].")
    model = _Field("array of float64 [values]: the same of the fitted model.")
    picture = _Field("str: path of measured and model as an SVG; None without `out`.")

    def __init__(self, fields):
        super().__init__(fields)
        self.measured, self.model = _floats(self.measured), _floats(self.model)
        self.picture = None

    @property
    def residuals(self):
        """array of float64 [values]: model - measured [N or m]."""
        return _floats(m - d for m, d in zip(self.model, self.measured))


class Fit(Answer):
    """The answer of `fit`. fit["c1"], or fit["gel", "c1"] where several materials have one, is a
    Parameter."""

    file = _Field("str: path of the experiment file.")
    title = _Field("str: its title.")
    converged = _Field("bool: the squares are as small as they get.")
    interrupted = _Field("bool: ended early; values are the best so far, without intervals.")
    values = _Field("int: how many numbers were measured.")
    runs = _Field("int: how many simulations it took.")
    wall_time = _Field("float: time that it took [s].")
    deviation = _Field("float: of what is left, in units of the noise, for each degree of freedom; "
                       "None: cannot be told.")
    parameters = _Field("list of Parameter.")
    experiments = _Field("list of Experiment.")
    notes = _Field("list of str: what stands at a bound, what cannot be told, what is no chance.")

    def __init__(self, fields, out=None):
        super().__init__({**fields, "parameters": [], "experiments": []})
        self.parameters = [Parameter(one) for one in fields["parameters"]]
        self.experiments = [Experiment(one) for one in fields["experiments"]]
        if out is not None:
            self._find_files(out)

    def _find_files(self, out):
        import os

        def there(name):
            path = os.path.join(out, name)
            return path if os.path.exists(path) else None

        for one in self.parameters:
            one.tissue = there(_file_name(one.material) + ".tissue.yaml")
        for number, one in enumerate(self.experiments, 1):
            one.picture = there(f"{number}_{_file_name(one.name)}.svg")

    def __getitem__(self, key):
        material, name = key if isinstance(key, tuple) else (None, key)
        found = [p for p in self.parameters
                 if p.parameter == name and material in (None, p.material)]
        if not found:
            raise KeyError(key)
        if len(found) > 1:
            raise KeyError(f"{name} is a parameter of {', '.join(p.material for p in found)}: say "
                           "of which, as in fit[material, parameter]")
        return found[0]

    @property
    def untold(self):
        """list of Parameter: those that the data cannot tell."""
        return [one for one in self.parameters if not one.told]


def _floats(values):
    return _array("d", (_nan if v is None else v for v in values))


def _file_name(name):
    """As the command calls files: ASCII letters, digits and -, of each other byte an _."""
    plain = b"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-"
    return "".join(chr(c) if c in plain else "_" for c in name.encode()[:63])


# ---- the calls -----------------------------------------------------------------------------------


def _ask(command, model, options):
    """Runs a command on a model, or on none. Its status says not what kind of failure it was: where
    the model is what it cannot read, the exception is that of Model."""
    import os

    from ._command import ask
    from ._lariat import Error, Model
    from ._scenes import Folder

    with Folder() as folder:
        named = [] if model is None else ["--", folder.model(model)]
        try:
            return Answer(ask(command, options + named, folder=folder, level=4))
        except Error as error:
            if type(error) is Error and named:
                try:
                    Model(os.path.join(folder.path or "", named[1]))
                except Error as kind:
                    raise type(kind)(*error.args) from None
            raise


def info(model, *, against=None, scale=None, speed=True):
    """What a model holds, how good its elements are, and how fast it runs on one core here.

    model    a Model, a Meshing, a path (scene, deck or mesh), or a scene as a dict
    against  path of a surface (.stl .obj .vtk .vtp) to compare the mesh with, in place of the
             model's embedded one: an outer surface, since of bodies in it that overlap what is
             inside another counts as far from the mesh
    scale    metres per unit of that surface (1)
    speed    False: do not step the model to see how fast it is, which takes up to some seconds

    Returns an Answer: nodes, elements, materials, sets, quality, time_step [s], speed, ...; all keys
    are those of `lariat info --json` (docs/cli.md). Runs the command, which must be there; Ctrl-C
    ends it. A mesh that is probably in millimetres is a UserWarning.
    """
    import os

    from ._command import options
    from ._lariat import Error, FileError
    from ._scenes import path_of

    if model is None:
        raise TypeError("model: expected a Model, a path or a scene as a dict, got None")
    if against is not None:
        against = path_of(against, "against")
    try:
        return _ask("info", model, options(against=against, scale=scale, no_speed=not speed))
    except Error as error:
        if type(error) is Error and against is not None and not os.path.exists(against):
            raise FileError(*error.args) from None
        raise


def requirements(model=None, *, grid=None, distribution=None, iterations=None, implicit_step=None,
                 thesis=False, speed=True):
    """How many operations and bytes a model needs in a step and in a second, counted, and how many
    cores of this machine, measured.

    model          a Model, a Meshing, a path, or a scene as a dict; None with thesis=True: the
                   thesis's own quantities
    grid           processors along x, y and z, for what is sent: "3x2x2", the thesis's
    distribution   path: who has which element; None: the model is cut
    iterations     of the implicit solver in a step (100)
    implicit_step  of the implicit method [s] (0.02)
    thesis         the thesis's numbers beside those of the model
    speed          False: measure nothing here, which takes some tenths of a second

    Returns an Answer with the keys of `lariat requirements --json` (docs/cli.md). Runs the command.
    """
    from ._command import options
    from ._scenes import path_of

    given = options(grid=grid, iterations=iterations, implicit_step=implicit_step, thesis=thesis,
                    distribution=None if distribution is None
                    else path_of(distribution, "distribution"), no_speed=not speed)
    return _ask("requirements", model, given)


def predict(model=None, grid=None, *, machine=None, processor_speed=None, latency=None,
            overhead=None, bandwidth=None, threads=None, scheme=None, channels=None,
            distribution=None, schedules=None, steps=None, measure=False, comm=None, check=False,
            repeat=None, trace=None, svg=None, scale_to=None, elements_per_processor=None,
            critical=False, list_machines=False):
    """How long a step would take on a parallel computer that is not here.

    model      a Model, a Meshing, a path, or a scene as a dict; None with scale_to, critical or
               list_machines
    grid       processors along x, y and z: "2x2x3"
    machine    a name of those that list_machines=True answers ("thesis"), or the path of a file
               that describes one
    processor_speed  nanoseconds per element (8.7), or "500MFLOPS"
    latency, overhead   of a packet on its way, and of the processor for sending it [us]
    bandwidth  of a link in each direction [MB/s]
    threads, scheme, channels, distribution, schedules   as for Simulation; paths of files
    steps      that are simulated (as many as it takes)
    measure    True: the machine is this one, measured now, in about ten seconds; comm: "threads",
               "shm"; check: run the model as well, and compare; repeat: samples of that (9)
    trace, svg paths: who did what when in a step, as CSV and as a picture
    scale_to   list of numbers of processors: bodies of equal blocks, without a model;
               elements_per_processor of them (150)
    critical   True: the smallest block with an efficiency of 90 %, without a model
    list_machines   True: all numbers of all machines, with their sources

    Returns an Answer with the keys of `lariat predict --json` (docs/cli.md): step_us [us], speed_up,
    efficiency, ... Runs the command; Ctrl-C ends it.
    """
    from ._command import options
    from ._scenes import path_of

    paths = {"distribution": distribution, "schedules": schedules, "trace": trace, "svg": svg}
    paths = {name: None if path is None else path_of(path, name) for name, path in paths.items()}
    if isinstance(machine, str) and not ("." in machine or "/" in machine):
        paths["machine"] = machine
    elif machine is not None:
        paths["machine"] = path_of(machine, "machine")
    if scale_to is not None:
        scale_to = ",".join(str(int(count)) for count in scale_to)
    return _ask("predict", model, options(
        grid=grid, processor_speed=processor_speed, latency=latency, overhead=overhead,
        bandwidth=bandwidth, threads=threads, scheme=scheme, channels=channels, steps=steps,
        measure=measure, comm=comm, check=check, repeat=repeat, scale_to=scale_to,
        elements_per_processor=elements_per_processor, critical=critical,
        list_machines=list_machines, **paths))


def fit(experiment, *, out=None, progress=None):
    """Parameters of tissue with which simulations answer as experiments did.

    experiment  path of an experiment file (docs/formats.md), or what is in one as a dict: scenes
                may be Models, Meshings or dicts, and tables (`data`, `pressure`) dicts of columns,
                [rows] each: {"displacement": [m], "force": [N], "time": [s]}
    out         folder for tissue files, pictures and fit.json; None: nothing is written
    progress    called with a dict after simulations: doing, residual (root mean square in units of
                the noise), runs, remaining [s] or None; False ends the fit. True: tqdm's bar where
                tqdm is installed

    Returns a Fit. Runs the command, which simulates on all cores. Ctrl-C, as False, ends the fit
    with the best values so far (`interrupted`); a second one, or one before there are any, is
    KeyboardInterrupt. A first guess with which a scene is unstable is an UnstableError.
    """
    import os

    from ._command import ask
    from ._lariat import FileError
    from ._scenes import Folder, path_of

    if progress is not None and progress is not True and not callable(progress):
        raise TypeError(f"progress: expected something to call, or True, got {type(progress)!r}")
    out = None if out is None else path_of(out, "out")
    options = ["--progress"] + (["--out", out] if out is not None else [])
    bar = _Bar() if progress is True else None
    with Folder() as folder:
        name = folder.experiment(experiment)
        if not folder.path and not os.path.exists(name):
            raise FileError(f"{name}: there is no such file; check the path")
        try:
            return Fit(ask("fit", [*options, "--", name], folder=folder,
                           progress=bar.show if bar else progress, keeps=True), out)
        finally:
            if bar:
                bar.close()


def profiles(film, view, *, out=None):
    """Profiles of tissue in a tube, read from side views: the data of an aspiration for `fit`.

    film  path of a folder of grey images (.pgm, .png), or of a list of them (.txt)
    view  path of the view file (docs/formats.md), or what is in it as a dict
    out   folder for profiles.csv, which an aspiration reads, and its picture; None: nothing

    Returns an Answer with the keys of `lariat fit --profile --json` (docs/cli.md): frames, points,
    uncertainty [m], ... Runs the command; Ctrl-C ends it.
    """
    from ._command import ask
    from ._scenes import Folder, path_of

    with Folder() as folder:
        options = ["--progress", "--profile", path_of(film, "film")]
        if out is not None:
            options += ["--out", path_of(out, "out")]
        if isinstance(view, dict):
            named = folder.dict_file("view.yaml", {"lariat-view": 1, **view}, "view")
        else:
            named = path_of(view, "view")
        return Answer(ask("fit", [*options, "--", named], folder=folder))


class _Bar:
    """tqdm's bar of simulations, where tqdm is installed; else nothing is shown."""

    def __init__(self):
        try:
            from tqdm.auto import tqdm
        except ImportError:
            self.bar = None
        else:
            self.bar = tqdm(unit=" simulations")

    def show(self, now):
        if self.bar is not None:
            self.bar.update(now["runs"] - self.bar.n)
            self.bar.set_postfix_str(f"{now['doing']}, residual {now['residual']}")

    def close(self):
        if self.bar is not None:
            self.bar.close()
