"""What the flows of this package declare; written by `python -m stability.flows.declaration`."""

DECLARED = {
    'vortex': (
        'longitudinal vortices in granular flow down an inclined plane',
        'length: depth h of the layer; velocity: I(tan slope) sqrt(phi g h cos slope) h/d; time: h over velocity; Fr2: velocity^2 / (g h cos slope), thesis (4.6)',  # noqa: E501
        False,
        (
            ('slope_deg', '30.0', {'meaning': 'inclination of the plane, degrees', 'low': 0, 'high': 90, 'closed': False, 'unbounded': False, 'reason': ''}, '1 to 89'),  # noqa: E501
            ('Fr2', '0.1', {'meaning': 'squared Froude number, thesis (4.6)', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.001 to 1000'),  # noqa: E501
        ),
    ),
    'dune': (
        'dunes on a granular bed sheared by a viscous fluid',
        "length: grain diameter d; time: sqrt(d/g'); granular velocity: sqrt(g' d); Re: fluid shear rate * d^2 / viscosity; depth: fluid depth / d",  # noqa: E501
        True,
        (
            ('shields', '2.0', {'meaning': 'fluid shear stress over the yield stress of the bed, thesis (4.54)', 'low': 1, 'high': None, 'closed': False, 'unbounded': False, 'reason': 'at or below 1 the bed does not yield'}, '1.01 to 20'),  # noqa: E501
            ('mu1', '0.4', {'meaning': 'static friction coefficient, thesis (4.48)', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('b', '1.0', {'meaning': 'rate coefficient of friction mu1 (1 + b I), thesis (4.48)', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 20'),  # noqa: E501
            ('Re', '10.0', {'meaning': 'Reynolds number of the fluid on the grain scale, thesis (4.39)', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.001 to 10000'),  # noqa: E501
            ('depth', 'inf', {'meaning': 'fluid depth in grain diameters; inf: unbounded fluid', 'low': 0, 'high': None, 'closed': False, 'unbounded': True, 'reason': ''}, '0.1 to 1000'),  # noqa: E501
            ('fluid', 'closed-form', {'meaning': 'wall stress in closed form, or a second layer', 'options': ('closed-form', 'layer')}, ''),  # noqa: E501
        ),
    ),
    'rollwave': (
        'roll waves in granular flow down an inclined plane',
        "length: depth h of the layer; velocity: I(tan slope) sqrt(phi g h cos slope) h/d; time: h over velocity; Fr2: velocity^2 / (g h cos slope), thesis (4.6); Forterre's Froude number, mean speed / sqrt(g h cos slope): 0.4 sqrt(Fr2)",  # noqa: E501
        True,
        (
            ('slope_deg', '28.0', {'meaning': 'inclination of the plane, degrees, between those of mu1 and mu2', 'low': 0, 'high': 90, 'closed': False, 'unbounded': False, 'reason': ''}, '1 to 89'),  # noqa: E501
            ('Fr2', '4.0', {'meaning': 'squared Froude number, thesis (4.6)', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.001 to 1000'),  # noqa: E501
            ('mu1', '0.3818628674187188', {'meaning': 'friction at rest', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('mu2', '0.6434683848584607', {'meaning': 'friction of rapid flow', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
        ),
    ),
    'film': (
        'liquid film falling down an inclined plane',
        'length: depth of the film; velocity: at its surface; Re: depth * surface speed / kinematic viscosity, 3/2 of the one on the mean speed; We: surface tension / (density * surface speed^2 * depth)',  # noqa: E501
        False,
        (
            ('Re', '10.0', {'meaning': 'Reynolds number of depth and surface speed', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.001 to 20000'),  # noqa: E501
            ('slope_deg', '30.0', {'meaning': 'inclination of the plane, degrees; beyond 90 the film hangs', 'low': 0, 'high': 180, 'closed': False, 'unbounded': False, 'reason': ''}, '0.005 to 175'),  # noqa: E501
            ('We', '0.0', {'meaning': 'surface tension / (density * surface speed^2 * depth)', 'low': 0, 'high': None, 'closed': True, 'unbounded': False, 'reason': ''}, '1e-05 to 1000'),  # noqa: E501
        ),
    ),
    'two_layer_couette': (
        'two liquids in plane Couette flow',
        'length: depth of the upper liquid; velocity: of the upper plate, the lower is at rest; Re: length * velocity / kinematic viscosity of the upper liquid; ratios: lower liquid over upper; gravity: g * length / velocity^2; tension: surface tension / (density of the upper liquid * velocity^2 * length)',  # noqa: E501
        False,
        (
            ('viscosity_ratio', '2.0', {'meaning': 'viscosity of the lower liquid over that of the upper', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.02 to 50'),  # noqa: E501
            ('depth_ratio', '1.0', {'meaning': 'depth of the lower liquid over that of the upper', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 20'),  # noqa: E501
            ('density_ratio', '1.0', {'meaning': 'density of the lower liquid over that of the upper', 'low': 0, 'high': None, 'closed': True, 'unbounded': False, 'reason': ''}, '0.1 to 10'),  # noqa: E501
            ('Re', '10.0', {'meaning': 'Reynolds number of the upper liquid and the plate speed', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.1 to 10000'),  # noqa: E501
            ('gravity', '0.0', {'meaning': 'g * depth / speed^2 of the upper liquid and plate', 'low': 0, 'high': None, 'closed': True, 'unbounded': False, 'reason': ''}, '0.001 to 100'),  # noqa: E501
            ('tension', '0.0', {'meaning': 'surface tension / (density * speed^2 * depth)', 'low': 0, 'high': None, 'closed': True, 'unbounded': False, 'reason': ''}, '0.001 to 100'),  # noqa: E501
        ),
    ),
    'poiseuille': (
        'plane Poiseuille flow between two plates',
        'length: half the distance of the plates; velocity: on the centreline; Re: half-width * centreline speed / kinematic viscosity',  # noqa: E501
        False,
        (
            ('Re', '10000.0', {'meaning': 'Reynolds number of half-width and centreline speed', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '10 to 100000'),  # noqa: E501
        ),
    ),
    'couette': (
        'plane Couette flow between two plates',
        'length: half the distance of the plates; velocity: half their difference in speed; Re: half-width * half the speed difference / kinematic viscosity',  # noqa: E501
        False,
        (
            ('Re', '1000.0', {'meaning': 'Reynolds number of half-width and half the wall speed difference', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '10 to 10000'),  # noqa: E501
        ),
    ),
    'plane_shear': (
        'plane shear of grains between plates, without gravity',
        'length: distance of the plates; velocity: that of the upper plate; stress: pressure',
        True,
        (
            ('mu1', '0.3818628674187188', {'meaning': 'friction at rest', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('mu2', '0.6434683848584607', {'meaning': 'friction of rapid flow', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('I0', '0.279', {'meaning': 'inertial number at which friction is half-way between', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.01 to 10'),  # noqa: E501
            ('inertial', '0.1', {'meaning': 'inertial number I: (shear rate) d/sqrt(p/density)', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.001 to 10'),  # noqa: E501
            ('inertia', '1.0', {'meaning': 'density (plate velocity)^2 / pressure, (I l/d)^2', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.001 to 10000'),  # noqa: E501
        ),
    ),
    'plate': (
        'grains under a dragged heavy plate',
        'length: z0 = plate pressure / (density g); velocity: z0 sqrt(g z0) / d, in the thesis I0 times that; stress: plate pressure',  # noqa: E501
        True,
        (
            ('mu1', '0.3818628674187188', {'meaning': 'friction at rest', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('mu2', '0.6434683848584607', {'meaning': 'friction of rapid flow', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('I0', '0.279', {'meaning': 'inertial number at which friction is half-way between', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.01 to 10'),  # noqa: E501
            ('shields', '1.2', {'meaning': 'shear stress on the plate over yield stress there', 'low': 1, 'high': None, 'closed': False, 'unbounded': False, 'reason': 'at or below 1 the bed does not yield'}, '1.01 to 20'),  # noqa: E501
            ('grains', '10.0', {'meaning': 'z0 in grain diameters; inertia is its square', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '1 to 1000'),  # noqa: E501
        ),
    ),
    'chute': (
        'grains falling between vertical walls, with a plug',
        'length: half-width L; velocity: L sqrt(g L) / d, in the thesis I0 times that; stress: density g L',
        True,
        (
            ('mu1', '0.3818628674187188', {'meaning': 'friction at rest', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('mu2', '0.6434683848584607', {'meaning': 'friction of rapid flow', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('I0', '0.279', {'meaning': 'inertial number at which friction is half-way between', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.01 to 10'),  # noqa: E501
            ('plug', '0.8', {'meaning': 'half-width W of the plug over that of the chute: mu1 pressure / (density g L)', 'low': 0, 'high': 1, 'closed': False, 'unbounded': False, 'reason': 'at or above 1 nothing flows'}, '0.05 to 0.99'),  # noqa: E501
            ('grains', '10.0', {'meaning': 'L in grain diameters; inertia is its square', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '1 to 1000'),  # noqa: E501
        ),
    ),
    'pile': (
        'flow on a deep pile between side walls',
        'length: width W between the walls; velocity: W sqrt(g cos(slope) W) / d; stress: density g cos(slope) W',
        True,
        (
            ('mu1', '0.3818628674187188', {'meaning': 'friction at rest', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('mu2', '0.6434683848584607', {'meaning': 'friction of rapid flow', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('I0', '0.279', {'meaning': 'inertial number at which friction is half-way between', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.01 to 10'),  # noqa: E501
            ('slope_deg', '28.0', {'meaning': 'inclination of the surface, degrees', 'low': 0, 'high': 90, 'closed': False, 'unbounded': False, 'reason': ''}, '1 to 89'),  # noqa: E501
            ('mu_wall', '0.3', {'meaning': 'friction coefficient of the side walls', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.01 to 2'),  # noqa: E501
        ),
    ),
    'annulus': (
        'annular shear of grains around a turning cylinder',
        "length: radius r0 of the cylinder; velocity: sqrt(p0/density); stress: p0, the pressure of the grains at rest; the thesis's Gamma_0 = I0 Gamma",  # noqa: E501
        True,
        (
            ('mu1', '0.3818628674187188', {'meaning': 'friction at rest', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('mu2', '0.6434683848584607', {'meaning': 'friction of rapid flow', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.05 to 2'),  # noqa: E501
            ('I0', '0.279', {'meaning': 'inertial number at which friction is half-way between', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.01 to 10'),  # noqa: E501
            ('thickness', '0.1', {'meaning': 'thickness Ry - 1 of the sheared layer: the torque', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.001 to 1'),  # noqa: E501
            ('gamma', '10.0', {'meaning': 'sqrt(volume fraction) r0/d; thesis: Gamma_0 over I0', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '0.1 to 1000'),  # noqa: E501
        ),
    ),
    'shear': (
        'parallel flow of a viscous fluid of any velocity U(z)',
        'length and velocity: those in which U(z) is given; Re: length * velocity / kinematic viscosity; blasius: in displacement thicknesses',  # noqa: E501
        False,
        (
            ('profile', 'poiseuille', {'meaning': 'U(z): a known velocity, or a CSV file with columns z, U and perhaps U_error, the standard error of U', 'table': True, 'kinds': 'poiseuille|bickley|tanh|blasius|FILE'}, ''),  # noqa: E501
            ('Re', '100.0', {'meaning': 'Reynolds number of the scales of U(z)', 'low': 0, 'high': None, 'closed': False, 'unbounded': False, 'reason': ''}, '1 to 100000'),  # noqa: E501
            ('bottom', 'wall', {'meaning': 'lower edge: no slip, no stress, or at infinity', 'options': ('wall', 'free', 'decay')}, ''),  # noqa: E501
            ('top', 'wall', {'meaning': 'upper edge: no slip, no stress, or at infinity', 'options': ('wall', 'free', 'decay')}, ''),  # noqa: E501
            ('z_low', '-inf', {'meaning': 'height of a lower wall or free edge; -inf: where the profile has its own', 'low': None, 'high': None, 'closed': False, 'unbounded': True, 'reason': ''}, '0.1 to 10'),  # noqa: E501
            ('z_high', 'inf', {'meaning': 'height of an upper wall or free edge; inf: where the profile has its own', 'low': None, 'high': None, 'closed': False, 'unbounded': True, 'reason': ''}, '0.1 to 10'),  # noqa: E501
        ),
    ),
}
