"""What the flows of this package declare; written by `python -m stability.flows.declaration`."""

DECLARED = {
    'vortex': (
        'longitudinal vortices in granular flow down an inclined plane',
        'length: depth h of the layer; velocity: I(tan slope) sqrt(phi g h cos slope) h/d; time: h over velocity; Fr2: velocity^2 / (g h cos slope), thesis (4.6)',  # noqa: E501
        (
            ('slope_deg', '30.0', '(0, 90)', 'inclination of the plane, degrees; searched from 1 to 89'),
            ('Fr2', '0.1', '(0, inf)', 'squared Froude number, thesis (4.6); searched from 0.001 to 1000'),
        ),
    ),
    'dune': (
        'dunes on a granular bed sheared by a viscous fluid',
        "length: grain diameter d; time: sqrt(d/g'); granular velocity: sqrt(g' d); Re: fluid shear rate * d^2 / viscosity; depth: fluid depth / d",  # noqa: E501
        (
            ('shields', '2.0', '(1, inf)', 'fluid shear stress over the yield stress of the bed, thesis (4.54); searched from 1.01 to 20'),  # noqa: E501
            ('mu1', '0.4', '(0, inf)', 'static friction coefficient, thesis (4.48); searched from 0.05 to 2'),
            ('b', '1.0', '(0, inf)', 'rate coefficient of friction mu1 (1 + b I), thesis (4.48); searched from 0.05 to 20'),  # noqa: E501
            ('Re', '10.0', '(0, inf)', 'Reynolds number of the fluid on the grain scale, thesis (4.39); searched from 0.001 to 10000'),  # noqa: E501
            ('depth', 'inf', '(0, inf]', 'fluid depth in grain diameters; inf: unbounded fluid; searched from 0.1 to 1000'),  # noqa: E501
            ('fluid', 'closed-form', 'closed-form | layer', 'wall stress in closed form, or a second layer'),
        ),
    ),
    'rollwave': (
        'roll waves in granular flow down an inclined plane',
        "length: depth h of the layer; velocity: I(tan slope) sqrt(phi g h cos slope) h/d; time: h over velocity; Fr2: velocity^2 / (g h cos slope), thesis (4.6); Forterre's Froude number, mean speed / sqrt(g h cos slope): 0.4 sqrt(Fr2)",  # noqa: E501
        (
            ('slope_deg', '28.0', '(0, 90)', 'inclination of the plane, degrees, between those of mu1 and mu2; searched from 1 to 89'),  # noqa: E501
            ('Fr2', '4.0', '(0, inf)', 'squared Froude number, thesis (4.6); searched from 0.001 to 1000'),
            ('mu1', '0.3818628674187188', '(0, inf)', 'friction at rest; searched from 0.05 to 2'),
            ('mu2', '0.6434683848584607', '(0, inf)', 'friction of rapid flow; searched from 0.05 to 2'),
        ),
    ),
    'film': (
        'liquid film falling down an inclined plane',
        'length: depth of the film; velocity: at its surface; Re: depth * surface speed / kinematic viscosity, 3/2 of the one on the mean speed; We: surface tension / (density * surface speed^2 * depth)',  # noqa: E501
        (
            ('Re', '10.0', '(0, inf)', 'Reynolds number of depth and surface speed; searched from 0.001 to 20000'),
            ('slope_deg', '30.0', '(0, 180)', 'inclination of the plane, degrees; beyond 90 the film hangs; searched from 0.005 to 175'),  # noqa: E501
            ('We', '0.0', '[0, inf)', 'surface tension / (density * surface speed^2 * depth); searched from 1e-05 to 1000'),  # noqa: E501
        ),
    ),
    'two_layer_couette': (
        'two liquids in plane Couette flow',
        'length: depth of the upper liquid; velocity: of the upper plate, the lower is at rest; Re: length * velocity / kinematic viscosity of the upper liquid; ratios: lower liquid over upper; gravity: g * length / velocity^2; tension: surface tension / (density of the upper liquid * velocity^2 * length)',  # noqa: E501
        (
            ('viscosity_ratio', '2.0', '(0, inf)', 'viscosity of the lower liquid over that of the upper; searched from 0.02 to 50'),  # noqa: E501
            ('depth_ratio', '1.0', '(0, inf)', 'depth of the lower liquid over that of the upper; searched from 0.05 to 20'),  # noqa: E501
            ('density_ratio', '1.0', '[0, inf)', 'density of the lower liquid over that of the upper; searched from 0.1 to 10'),  # noqa: E501
            ('Re', '10.0', '(0, inf)', 'Reynolds number of the upper liquid and the plate speed; searched from 0.1 to 10000'),  # noqa: E501
            ('gravity', '0.0', '[0, inf)', 'g * depth / speed^2 of the upper liquid and plate; searched from 0.001 to 100'),  # noqa: E501
            ('tension', '0.0', '[0, inf)', 'surface tension / (density * speed^2 * depth); searched from 0.001 to 100'),
        ),
    ),
    'poiseuille': (
        'plane Poiseuille flow between two plates',
        'length: half the distance of the plates; velocity: on the centreline; Re: half-width * centreline speed / kinematic viscosity',  # noqa: E501
        (
            ('Re', '10000.0', '(0, inf)', 'Reynolds number of half-width and centreline speed; searched from 10 to 100000'),  # noqa: E501
        ),
    ),
    'couette': (
        'plane Couette flow between two plates',
        'length: half the distance of the plates; velocity: half their difference in speed; Re: half-width * half the speed difference / kinematic viscosity',  # noqa: E501
        (
            ('Re', '1000.0', '(0, inf)', 'Reynolds number of half-width and half the wall speed difference; searched from 10 to 10000'),  # noqa: E501
        ),
    ),
    'plane_shear': (
        'plane shear of grains between plates, without gravity',
        'length: distance of the plates; velocity: that of the upper plate; stress: pressure',
        (
            ('mu1', '0.3818628674187188', '(0, inf)', 'friction at rest; searched from 0.05 to 2'),
            ('mu2', '0.6434683848584607', '(0, inf)', 'friction of rapid flow; searched from 0.05 to 2'),
            ('I0', '0.279', '(0, inf)', 'inertial number at which friction is half-way between; searched from 0.01 to 10'),  # noqa: E501
            ('inertial', '0.1', '(0, inf)', 'inertial number I: (shear rate) d/sqrt(p/density); searched from 0.001 to 10'),  # noqa: E501
            ('inertia', '1.0', '(0, inf)', 'density (plate velocity)^2 / pressure, (I l/d)^2; searched from 0.001 to 10000'),  # noqa: E501
        ),
    ),
    'plate': (
        'grains under a dragged heavy plate',
        'length: z0 = plate pressure / (density g); velocity: z0 sqrt(g z0) / d, in the thesis I0 times that; stress: plate pressure',  # noqa: E501
        (
            ('mu1', '0.3818628674187188', '(0, inf)', 'friction at rest; searched from 0.05 to 2'),
            ('mu2', '0.6434683848584607', '(0, inf)', 'friction of rapid flow; searched from 0.05 to 2'),
            ('I0', '0.279', '(0, inf)', 'inertial number at which friction is half-way between; searched from 0.01 to 10'),  # noqa: E501
            ('shields', '1.2', '(1, inf)', 'shear stress on the plate over yield stress there; searched from 1.01 to 20'),  # noqa: E501
            ('grains', '10.0', '(0, inf)', 'z0 in grain diameters; inertia is its square; searched from 1 to 1000'),
        ),
    ),
    'chute': (
        'grains falling between vertical walls, with a plug',
        'length: half-width L; velocity: L sqrt(g L) / d, in the thesis I0 times that; stress: density g L',
        (
            ('mu1', '0.3818628674187188', '(0, inf)', 'friction at rest; searched from 0.05 to 2'),
            ('mu2', '0.6434683848584607', '(0, inf)', 'friction of rapid flow; searched from 0.05 to 2'),
            ('I0', '0.279', '(0, inf)', 'inertial number at which friction is half-way between; searched from 0.01 to 10'),  # noqa: E501
            ('plug', '0.8', '(0, 1)', 'half-width W of the plug over that of the chute: mu1 pressure / (density g L); searched from 0.05 to 0.99'),  # noqa: E501
            ('grains', '10.0', '(0, inf)', 'L in grain diameters; inertia is its square; searched from 1 to 1000'),
        ),
    ),
    'pile': (
        'flow on a deep pile between side walls',
        'length: width W between the walls; velocity: W sqrt(g cos(slope) W) / d; stress: density g cos(slope) W',
        (
            ('mu1', '0.3818628674187188', '(0, inf)', 'friction at rest; searched from 0.05 to 2'),
            ('mu2', '0.6434683848584607', '(0, inf)', 'friction of rapid flow; searched from 0.05 to 2'),
            ('I0', '0.279', '(0, inf)', 'inertial number at which friction is half-way between; searched from 0.01 to 10'),  # noqa: E501
            ('slope_deg', '28.0', '(0, 90)', 'inclination of the surface, degrees; searched from 1 to 89'),
            ('mu_wall', '0.3', '(0, inf)', 'friction coefficient of the side walls; searched from 0.01 to 2'),
        ),
    ),
    'annulus': (
        'annular shear of grains around a turning cylinder',
        "length: radius r0 of the cylinder; velocity: sqrt(p0/density); stress: p0, the pressure of the grains at rest; the thesis's Gamma_0 = I0 Gamma",  # noqa: E501
        (
            ('mu1', '0.3818628674187188', '(0, inf)', 'friction at rest; searched from 0.05 to 2'),
            ('mu2', '0.6434683848584607', '(0, inf)', 'friction of rapid flow; searched from 0.05 to 2'),
            ('I0', '0.279', '(0, inf)', 'inertial number at which friction is half-way between; searched from 0.01 to 10'),  # noqa: E501
            ('thickness', '0.1', '(0, inf)', 'thickness Ry - 1 of the sheared layer: the torque; searched from 0.001 to 1'),  # noqa: E501
            ('gamma', '10.0', '(0, inf)', 'sqrt(volume fraction) r0/d; thesis: Gamma_0 over I0; searched from 0.1 to 1000'),  # noqa: E501
        ),
    ),
    'shear': (
        'parallel flow of a viscous fluid of any velocity U(z)',
        'length and velocity: those in which U(z) is given; Re: length * velocity / kinematic viscosity; blasius: in displacement thicknesses',  # noqa: E501
        (
            ('profile', 'poiseuille', 'poiseuille|bickley|tanh|blasius|FILE', 'U(z): a known velocity, or a CSV file with columns z, U and perhaps U_error, the standard error of U'),  # noqa: E501
            ('Re', '100.0', '(0, inf)', 'Reynolds number of the scales of U(z); searched from 1 to 100000'),
            ('bottom', 'wall', 'wall | free | decay', 'lower edge: no slip, no stress, or at infinity'),
            ('top', 'wall', 'wall | free | decay', 'upper edge: no slip, no stress, or at infinity'),
            ('z_low', '-inf', '[-inf, inf]', 'height of a lower wall or free edge; -inf: where the profile has its own; searched from 0.1 to 10'),  # noqa: E501
            ('z_high', 'inf', '[-inf, inf]', 'height of an upper wall or free edge; inf: where the profile has its own; searched from 0.1 to 10'),  # noqa: E501
        ),
    ),
}
