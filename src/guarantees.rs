//! Guarantees: what the integrator and the searches promise, and the test that checks each promise.
//!
//! This page contains no items. A test is named by program, module and function. In a clone, run
//! for example
//!
//! ```sh
//! cargo test --release --test belt integrator::promise_2
//! ```
//!
//! # One mass on a belt
//!
//! The promises concern a [`MassOnBelt`](crate::MassOnBelt). v is the velocity of the mass, v_b
//! that of the belt, v_r = v − v_b the relative velocity, u the displacement, β the damping ratio
//! and γ² the friction load. The law has the static coefficient μ_s and, at the sliding speed s =
//! |v_r|, the kinetic coefficient μ̂(s). D = 2β + γ²·dμ̂/ds is the effective damping.
//!
//! 1. **Steps.** Each step of a slip phase is a Taylor series of order 26. Its defect is the
//!    residual that the series leaves in the equation of motion. A step is accepted if the defect
//!    is small at a quarter, a half and three quarters of the step, at its end, and near the
//!    minimum of the sliding speed. In a step longer than one radian the defect is also checked at
//!    every quarter of a radian. The checks catch terms of the law that are lost in rounding at the
//!    start of the step, such as exp(−400) in a law with a small Stribeck velocity. The checks find
//!    a narrow bump exp(−((s − s_0)/w)²) of the law at any sliding speed s_0, if w is at least 1/40
//!    of the motion's velocity amplitude. Declare a [breakpoint](crate::FrictionLaw::breakpoints)
//!    at any narrower feature. Tests: `belt::integrator::promise_1_hidden_terms_are_not_missed`,
//!    `belt::integrator::promise_1_features_passed_in_a_long_step_are_seen`,
//!    `belt::hostile::a_narrow_feature_is_not_missed_wherever_in_a_step_it_lies`.
//! 2. **Zeros of v_r** are roots of the polynomial of the sliding speed. They are isolated, so that
//!    none is skipped, and refined to the last bit. A shallow passage through v_r = 0 and back
//!    within one step is found. Tests:
//!    `belt::integrator::promise_2_shallow_grazing_contacts_are_found`,
//!    `belt::integrator::promise_2_shallow_contacts_of_a_circle`,
//!    `belt::independent::a_simple_integrator_sees_the_same_events`.
//! 3. **Start of slip.** v_r is 0 at the start of slip. This known root, simple or double, is
//!    divided out of the polynomial. There is no epsilon, no cooldown and no minimum duration: no
//!    event fires twice. Test: `belt::integrator::promise_3_phase_starts_need_no_epsilon`.
//! 4. **Stick** is computed by closed formulas, and v equals v_b in every bit. Tests:
//!    `belt::integrator::promise_4_stick_is_closed_form`,
//!    `belt::hostile::it_sticks_in_the_band_and_slips_outside`.
//! 5. **Order.** States are continuous. In stiff phases (promise 9) they may jump by up to 8
//!    tolerances between two steps. Event times never decrease; they increase strictly if the phase
//!    between two events is longer than an ulp of the time (the distance between two neighbouring
//!    numbers of type `f64`). The same call gives the same bits on the same kind of processor.
//!    Tests: `belt::integrator::promise_5_motion_is_continuous_and_ordered_and_repeatable`,
//!    `contract::api::the_same_bits_again_and_in_threads`.
//! 6. **Large numbers.** The integrated variable is v_r, not v, so the zeros of v_r are exact for
//!    large v_b. Time is summed with compensation for rounding errors: after 10⁵ cycles, the time
//!    of an event differs from the exact multiple of the period by at most 4 ulps. Tests:
//!    `belt::integrator::promise_6_contact_is_exact_for_large_belt_velocities`,
//!    `belt::integrator::promise_6_time_does_not_drift_over_a_hundred_thousand_cycles`.
//! 7. **Tolerance** is the error of a step relative to the scale of the motion, max(|u − ū|, |v|,
//!    |v_b|), with ū the displacement of steady sliding. A change of units therefore only scales
//!    the result. If a motion creeps (D large), or the law is so steep that |u − ū| is far larger
//!    than the range of the motion, the scale is max(|v|, |v_b|, |v'|/max(1, D)). Tests:
//!    `belt::integrator::promise_7_scaling_the_units_scales_the_result`,
//!    `belt::integrator::requested_tolerance_is_met`,
//!    `belt::hostile::other_units_of_length_change_no_bit`.
//! 8. **Errors.** A run that cannot continue returns a typed [`Error`](crate::Error) with the time
//!    and state reached. It does not panic or hang.
//!    Tests: `belt::integrator::promise_8_what_cannot_go_on_is_an_error_with_time_and_state`,
//!    `belt::hostile::every_run_ends_with_a_result_or_a_typed_error`.
//! 9. **Stiff phases.** If friction or the damper rises so steeply with the sliding speed that the
//!    motion creeps, a step is the power series of the slow manifold. The number of steps then does
//!    not grow with D, up to D of about 10²⁰. Where two of these steps meet, their states may
//!    differ by up to 8 tolerances. Tests: `belt::stiff::work_does_not_grow_with_the_stiffness`,
//!    `belt::stiff::stiff_motions_are_those_of_an_implicit_method`.
//!
//! **Accuracy.** Another method computed 22 reference motions with 25 digits; events and states
//! agree with them within 1e-13·max(1, |value|). Double precision with ε = 2.2e-16 sets two limits.
//! Near grazing, the time at which v_r reaches 0 is known to about ε/|v_r'|. Motions with v_b below
//! 2e-5·γ²μ_s are known to about ε·γ²μ_s/v_b. Test:
//! `belt::reference::trajectories_have_the_reference_events_and_states`.
//!
//! # Conventions at zero relative velocity
//!
//! In stick the contact transmits the force F = u + 2βv_b, and its limit is F_s = γ²μ_s. The band
//! of forces in which the mass sticks is half open for v_b ≠ 0 and closed for v_b = 0, so that
//! exactly one motion follows from every state:
//!
//! * v_b > 0: −F_s ≤ F < F_s. At F = F_s the mass is released.
//! * v_b < 0: −F_s < F ≤ F_s, the mirror image.
//! * v_b = 0: −F_s ≤ F ≤ F_s.
//!
//! In the table, rows that give a sign of v_r, but no sign of v_b, apply to v_b > 0. For v_b < 0
//! the sign of v_r is reversed.
//!
//! | situation | what happens |
//! |---|---|
//! | stick, v_b > 0: F grows at the rate v_b and reaches F_s | [`Release`](crate::EventKind::Release), slip with v_r < 0; u = F_s − 2βv_b, v = v_b |
//! | stick, v_b < 0: F reaches −F_s | `Release`, slip with v_r > 0 |
//! | stick, v_b = 0 | the mass stays at rest for ever |
//! | slip, v_r reaches 0, F in the band | [`Stick`](crate::EventKind::Stick), even if γ²μ̂(0) < \|F\|: static friction can hold the mass |
//! | slip, v_r reaches 0, F outside the band | [`Crossing`](crate::EventKind::Crossing): slip continues with the other sign. This includes slip with v_r > 0 that ends exactly at the open end of the band |
//! | slip with v_r < 0, v_r touches 0 tangentially at the open end of the band | no event, slip continues |
//! | start with v_r = 0 up to [rounding](#restart), F in the band | the mass sticks; no event at time 0 |
//! | the same, F outside the band, not at the release point | the mass slips at once, with the sign of −F; no event at time 0 |
//! | v_b > 0: start at the release point u = F_s − 2βv_b, v = v_b, within 4 ulps of the largest of these terms | `Release` at time 0, reported |
//!
//! [`stick_limits`](crate::MassOnBelt::stick_limits) returns the ends of the band as displacements
//! u; every decision uses these two numbers.
//! [`release_state`](crate::MassOnBelt::release_state) returns the release point.
//! Tests: `belt::integrator::ends_of_the_stick_band_are_half_open`,
//! `belt::integrator::arrival_at_the_open_end_from_leading_is_a_crossing`,
//! `belt::integrator::release_state_releases_at_time_zero`,
//! `belt::integrator::starts_beside_the_release_point_are_released_at_once`.
//!
//! # Structures
//!
//! A [`Structure`](crate::Structure) is integrated by the same method. The defect of each Taylor
//! series of order 26 is checked, every event is an isolated root of a polynomial, and known roots
//! at the start of slip are divided out. Errors are typed. Where friction rises steeply with the
//! sliding speed, or the memory of a slipping contact is stiff, such as bristles, the motion is
//! followed on its slow manifold; other stiffness shortens the (explicit) steps.
//!
//! * **Equation of motion, energy and events** agree with those of independent integrators:
//!   `structures::random::motions_obey_the_law`, `structures::identities::energy_balances`,
//!   `structures::random::a_simple_integrator_sees_the_same_events`.
//! * **Stick.** The state of a mass that sticks to a surface has the velocity that the drive of the
//!   surface returns for the same time, in every bit and however this velocity varies, if the
//!   contact is rigid and created by `Contact::new`, the mass has no second rigid contact, and the
//!   mass matrix does not couple it to other masses:
//!   `structures::restarts::a_mass_in_stick_has_the_velocity_of_its_belt_in_every_bit`,
//!   `structures::identities::a_stuck_mass_is_carried_exactly`. In other contacts that stick, r is
//!   0 to the rounding errors of its own terms.
//! * **[Restart](#restart).** A state that the crate returns is a start of the same motion:
//!   `structures::restarts::a_returned_state_is_a_start_of_the_same_motion`.
//! * **Reference motions** computed with 25 digits agree with the motions of the crate:
//!   `structures::trajectories::motions_have_the_reference_events_and_states`,
//!   `structures::memory::motions_have_the_reference_events_and_states`.
//! * **Contacts that share masses.** At the relative velocity r = 0, stick or slip is decided for
//!   all these contacts together, by the rule on the page of
//!   [`Structure`](crate::Structure#contacts-that-share-masses). The numbering of contacts does not
//!   matter. Let contacts c with directions b_c and surface velocities w_c reach r = 0. A contact
//!   with b = Σ a_c b_c and w = Σ a_c w_c, with any numbers a_c, then also reaches r = 0, and is
//!   decided together with them. Contacts with linearly dependent directions stick together until
//!   their limits together are exceeded, as limit analysis says:
//!   `structures::decisions::decisions_are_those_of_all_patterns_tried`,
//!   `structures::ties::ties_are_decided_as_by_all_patterns_tried`,
//!   `structures::ties::a_stack_of_one_material_moves_as_its_lumped_body`,
//!   `structures::contacts::contacts_may_be_numbered_in_any_order`,
//!   `structures::contacts::contacts_come_to_rest_with_those_that_they_depend_on`,
//!   `structures::contacts::parallel_clutches_lock_and_slip_together`,
//!   `structures::dependent::decisions_of_dependent_contacts_solve_the_programme`,
//!   `structures::dependent::a_ring_slips_at_the_least_sum_of_limits`.
//! * **Limits by direction.** Friction that is the same in both directions gives the same bits as a
//!   law of one coefficient: `structures::directional::equal_laws_are_one_law`. Unequal and
//!   infinite limits are decided by the same rule:
//!   `structures::decisions::decisions_of_limits_by_direction_are_those_of_all_patterns_tried`,
//!   `structures::directional::large_limits_are_infinite_ones`,
//!   `structures::directional::mirrored_systems_move_mirrored`.
//! * **Loads.** If a load that depends on time alone falls below 0 and rises again, its contact
//!   opens and closes. A load that only touches 0 causes no event. If a contact has a load
//!   gradient, no normal spring and no load law, and its load falls to 0, the motion ends with
//!   [`Error::Separation`](crate::Error::Separation):
//!   `structures::closed_forms::a_load_that_falls_to_zero_opens_the_contact`,
//!   `structures::random::a_load_that_touches_zero_does_not_open_or_close`,
//!   `structures::closed_forms::a_load_that_springs_lift_ends_the_motion`.
//! * **Elastic contacts** transmit exactly their limit force while they slip, for any tangential
//!   stiffness (tried from 1e-2 to 1e12 times the stiffness of the mass's spring):
//!   `structures::elastic::any_stiffness_has_every_event`. Energies balance. Two motions never come
//!   apart, measured by the energy of their difference, if loads depend on time alone, coefficients
//!   are constant, and K and C are symmetric and positive semidefinite:
//!   `structures::elastic_identities::two_motions_never_come_apart`,
//!   `structures::elastic_identities::energy_is_what_forces_and_sliders_leave`. A time-stepping
//!   scheme without modes and events reaches the same states:
//!   `structures::elastic::a_scheme_without_events_comes_to_the_same_states`.
//!   The force of an elastic contact in a state is exactly its limit if the slider moves, and at
//!   most its limit otherwise: `structures::restarts::sliders_carry_their_limit_in_every_bit`.
//! * **Force elements.** A linear element has the motions, events included, of the spring and
//!   damper that it is, to rounding errors and their magnification by the problem, also if it is
//!   divided into two, or multiplied by a factor:
//!   `structures::forces::a_linear_element_is_a_spring_and_a_damper`. Free vibrations on nonlinear
//!   springs have the periods of their closed forms, and conservative elements keep the energy to
//!   rounding errors:
//!   `structures::forces::free_vibrations_have_the_periods_of_their_closed_forms`,
//!   `structures::force_laws::energy_is_kept`,
//!   `structures::forces::a_rotation_symmetric_field_conserves_the_angular_momentum`. The work of a
//!   factor is the growth of the energy:
//!   `structures::forces::a_factor_is_a_stiffness_that_varies`. A motion that meets a singular
//!   point of a force ends with an error that names the place:
//!   `structures::forces::singular_points_of_a_force_are_named`.
//! * **First-order states.** A state has the motions, events included, of the velocity of a
//!   coordinate of mass 1 on whose displacement nothing depends, to rounding errors and their
//!   magnification by the problem:
//!   `structures::first_order::first_order_states_are_velocities_of_coordinates`.
//!   Linear systems follow the matrix exponential:
//!   `structures::first_order::linear_systems_follow_the_matrix_exponential`. Multipliers are those
//!   of the system with coordinates, and those of differences:
//!   `orbit::first_order::multipliers_are_those_of_coordinates_in_place_of_states`,
//!   `orbit::first_order::monodromy_is_the_derivative_of_the_period_map`.
//! * **Stops** close and open at roots, like other events. A free mass rebounds as the closed forms
//!   say. Two stops without dampers act as a [`Backlash`](crate::Backlash). Energies balance with
//!   the heat of the dampers of stops. A motion continues from each of its states:
//!   `structures::stops::a_free_mass_rebounds_as_the_formulas_say`,
//!   `structures::stops::two_stops_without_damper_are_backlash`,
//!   `structures::stops::energies_and_samples_of_stops`,
//!   `structures::stops::motions_continue_from_their_states`. Reference motions with stops agree:
//!   `structures::trajectories::stops_have_the_reference_events_and_states`. A stop that is never
//!   reached changes no bit: `structures::stops::a_stop_out_of_reach_changes_nothing`. Multipliers
//!   are those of differences, also where a stop releases contacts:
//!   `orbit::stops::saltation_at_stops_agrees_with_differences`.
//! * **Steady sliding with force elements** is one of several solutions, found by Newton's method
//!   from given displacements; no completeness is promised:
//!   `structures::forces::steady_sliding_is_found_with_nonlinear_forces`.
//! * **Symmetry.** Mirror images agree in every bit, and equal masses with equal states keep equal
//!   states in every bit: `structures::identities::mirror_images_agree_to_the_bit`,
//!   `structures::elastic_identities::mirror_images_agree_to_the_bit`,
//!   `structures::identities::clones_stay_together_to_the_bit`.
//! * **Phase.** The phase of a drive stays exact after any number of periods:
//!   `structures::identities::many_periods_lose_no_phase`.
//! * **Functions of time** ([`TimeFunction`](crate::TimeFunction)) are integrated as exactly as
//!   harmonics, and no step goes over a feature as wide as the timescale that the function names:
//!   `structures::functions::a_function_that_is_a_harmonic_gives_its_motions`,
//!   `structures::functions::no_step_goes_over_a_narrow_bump`.
//! * **One mass on a belt** has the same motion as a `MassOnBelt` and as a `Structure`, two
//!   separate engines: `structures::two_engines::reference_motions_of_the_belt`,
//!   `structures::two_engines::random_belts`.
//! * **Stiff bristles.** The number of steps in slip does not grow with the stiffness of the
//!   bristles (tried up to σ0 = 10¹²):
//!   `structures::stiff_memory::any_stiffness_takes_as_many_steps`.
//! * **Steep friction.** The number of steps in slip does not grow with the slope of friction by
//!   the sliding speed (tried up to 10¹⁵), at any number of contacts, also of contacts that share
//!   masses. On the slow manifold a sliding speed has a relative error of the tolerance, or that of
//!   rounding: 16 ε f/(s f') of the friction f at the sliding speed s. Where two of these steps
//!   meet, sliding speeds may differ by up to 8 of these errors:
//!   `structures::stiff_speed::work_does_not_grow_with_the_stiffness`,
//!   `structures::stiff_speed::one_mass_moves_as_on_its_belt`,
//!   `structures::stiff_speed::several_contacts_move_as_one`,
//!   `structures::stiff_speed::a_contact_between_masses_leaves_their_common_motion`,
//!   `structures::stiff_speed::two_masses_move_as_by_an_implicit_method`.
//! * **Seismic cycles.** Under rate-and-state friction, over up to 15 decades of the sliding speed,
//!   the passages of the plate's velocity in four motions agree with 25-digit values within 1e-13
//!   of their times, in at most 1.3 times the steps of an independent prototype. One to three
//!   sliders agree with an implicit method in the logarithm of the speed. Periodic motions return
//!   to their start within 1e-13; their multipliers are those of return maps within 1e-9.
//!   Eigenvalues of steady sliding satisfy the characteristic equation within 1e-13 of its terms,
//!   at 1e-18 m/s, too. Velocity steps and a cycle agree with the frozen results of two published
//!   programs, to their last digits:
//!   `structures::seismic::motions_have_the_reference_passages_and_states`,
//!   `structures::seismic::periods_without_inertia_are_the_limit_of_small_masses`,
//!   `structures::seismic::first_integrals_drift_in_proportion_to_the_mass`,
//!   `structures::seismic::random_sliders_move_as_by_an_implicit_method`,
//!   `structures::seismic::cycles_go_on_for_thousands_of_years`,
//!   `structures::rate_state::velocity_steps_are_those_of_rsfmodel`,
//!   `orbit::rate_state::a_cycle_has_the_period_of_qdyn`,
//!   `orbit::rate_state_searches::eigenvalues_are_those_of_the_characteristic_equation`,
//!   `orbit::rate_state_searches::curves_of_hopf_points_are_the_critical_stiffness_over_decades`,
//!   `orbit::rate_state::sections_have_the_reference_times_and_states`,
//!   `orbit::rate_state::multipliers_of_quakes_are_those_of_return_maps`,
//!   `orbit::rate_state::seismic_cycles_close_and_have_the_multipliers_of_differences`,
//!   `orbit::rate_state::a_cycle_shrinks_to_steady_sliding_at_the_critical_stiffness`.
//! * **Units** do not matter, as long as the angular frequencies and rates of a structure are
//!   between 1e-9 and 1e10 per unit of time. Steps are at most 2³² units long, so slower motions
//!   take more steps; faster ones end in [`Error::StepUnderflow`](crate::Error::StepUnderflow),
//!   because the coefficients of their series overflow:
//!   `structures::identities::the_unit_of_time_does_not_matter`.
//! * **Limits of work** (numbers of steps and events) are observed:
//!   `structures::random::limits_of_work_hold`.
//!
//! # Restart
//!
//! A motion that starts at a state of another motion, at the time of this state, has the same
//! events and states as the rest of that motion, up to rounding errors and their magnification by
//! the problem. The forces of [`carried`](crate::Structure::carried), the accelerations and the
//! samples agree, too: `structures::restarts::a_returned_state_is_a_start_of_the_same_motion`,
//! `structures::restarts::samples_agree_with_forces_and_accelerations_of_their_states`,
//! `structures::restarts::one_mass_goes_on_from_any_of_its_states_in_any_unit`. The conventions:
//!
//! * **At rest.** A state does not contain the modes of its contacts. A contact counts as at rest
//!   if |r| is within the rounding error of its terms: r = Σ b_j v_j − w with n products, |r| ≤ ε
//!   ((n + 3) S + |w' t|), where S is Σ |b_j v_j| plus the sizes of the terms of w, w' the
//!   acceleration of the surface, t the time and ε = 2.2e-16. For a mass on a belt of constant
//!   velocity the bound is 4ε(|v| + |v_b|). Stick or slip is then decided by the forces. A state
//!   cannot tell slower slip from stick: a start with v = v_b(1 + 2e-16) sticks if static friction
//!   can hold it:
//!   `structures::restarts::one_mass_goes_on_from_any_of_its_states_in_any_unit`.
//! * **Memory.** At r = 0 the memory of a start is that in stick. A motion that starts in stick
//!   with a dwell clock θ in its memory continues this clock:
//!   `structures::restarts::a_locked_clutch_stays_locked`.
//! * **Events.** The state of an event contains the memory before the event. A motion that starts
//!   from it decides between stick and slip as the event did.
//!   [`state_at`](crate::Trajectory::state_at) the time of the event returns the memory after it.
//!   If several contacts with dwell clocks are at rest at one event, start at the state of the
//!   event: their common decision depends on clocks that the event sets to 0:
//!   `structures::restarts::a_returned_state_is_a_start_of_the_same_motion`,
//!   `structures::restarts::a_state_where_a_load_jumps_is_a_start`.
//! * **Directions.** A contact whose law never sticks (bristles) has a direction of slip also while
//!   another contact holds its r at 0. No state contains this direction, and a start takes it as
//!   [`Leading`](crate::Direction::Leading); only a `Crossing` where the other contact is released
//!   depends on it: `structures::restarts::a_returned_state_is_a_start_of_the_same_motion`.
//!
//! # Completeness
//!
//! | search | complete? | test |
//! |---|---|---|
//! | [`limit_cycle::stick_slip`](crate::limit_cycle::stick_slip) | yes: if a cycle sticks, it is found | `cycles::maps::no_cycle_is_lost_or_invented` |
//! | [`limit_cycle::find`](crate::limit_cycle::find) | yes, except very small or very large cycles without stick, and pairs of cycles very close together; its page states the [limits](crate::limit_cycle#what-is-guaranteed); ranges that double precision cannot resolve are [reported](crate::CycleSet::unresolved) | `cycles::maps::no_cycle_is_lost_or_invented`, `cycles::cycles::every_number_of_the_reference`, `cycles::cases::canard_like_growth_is_resolved_or_told` |
//! | [`limit_cycle::attractor`](crate::limit_cycle::attractor), [`basins`](crate::limit_cycle::basins()) | as complete as `find`, since they use its cycles | `cycles::maps::motions_stay_near_stable_cycles_and_end_on_the_attractor_named` |
//! | functions of [`bifurcation`](crate::bifurcation) | depends on the function: its page states how densely it searches | `cycles::bifurcations::every_number_of_the_reference`, `cycles::brute_force::contacts_change_where_brute_force_says` |
//! | [`orbit::shoot`](crate::orbit::shoot), [`settle`](crate::orbit::settle) | no: one motion, searched from a given start state, exact to rounding, or a typed error | `orbit::references::orbits_have_the_reference_numbers`, `orbit::bad_input::what_is_not_found_says_how_far_it_is` |
//! | [`orbit::follow`](crate::orbit::follow) | no: only the branch connected with the start; two bifurcations of one kind within a step can be missed | `orbit::follow::bifurcations_of_forced_motions_are_those_of_the_reference`, `orbit::follow::both_directions_meet` |
//!
//! Motions of one mass on a belt of constant velocity lie in a plane and cannot cross each other,
//! so a search for its limit cycles can be complete. With a force, a second mass or memory
//! variables, motions can cross, and a search finds only a motion near the guess from which it
//! starts.
