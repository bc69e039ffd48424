"""stability critical: the value of a parameter at which a flow becomes unstable."""

from .common import accuracy_options, add_verb, flow_of, options_of, report


def add(verbs):
    add_verb(verbs, "critical", _run, "the value of a parameter at which the first wavenumber becomes unstable",
             "stability critical poiseuille --vary Re", vary_option, long_wave_option, accuracy_options)


def vary_option(verb, required=True):
    verb.add_argument("--vary", required=required, metavar="NAME",
                      help="parameter to solve for; the search starts from its value")


def long_wave_option(verb):
    verb.add_argument("--long-wave", action="store_true",
                      help="the threshold as k -> 0, even where waves of finite length grow on its stable side")


def _run(arguments):
    from ..neutral import check_parameter_name, critical

    flow, options = flow_of(arguments), options_of(arguments)
    vary = check_parameter_name(flow, arguments.vary.replace("-", "_"))

    def compute():
        return critical(flow, vary, long_wave=arguments.long_wave, strict=False, **options)

    return report(arguments, compute)
