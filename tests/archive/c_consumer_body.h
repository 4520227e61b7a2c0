/* SPDX-License-Identifier: MIT */
/* Included by c_consumer.c only, once a precision; hence no guard. */
int CONSUMER(const uint8_t* blob, size_t size) {
  static const REAL start[8] = {(REAL)0.3, (REAL)-1.2, (REAL)1.5, (REAL)0.4, (REAL)1.1, (REAL)-0.6, 0, 0};
  static const REAL wanted[6] = {(REAL)0.01, 0, 0, 0, 0, 0};
  static NAME(calibrated_arm) model, fresh;
  static union {
    double align;
    unsigned char bytes[sizeof(NAME(calibrated_arm)) + sizeof(NAME(compensator))];
  } room;
  NAME(calibrated_arm)* const crooked = (NAME(calibrated_arm)*)(void*)(room.bytes + 4);
  static NAME(compensator) loop_a, loop_b, blank;
  NAME(compensator)* const crooked_state = (NAME(compensator)*)(void*)(room.bytes + 4);
  NAME(tick_options) options, wrong;
  NAME(tick_report) report, report_before;
  NAME(pose) nominal, corrected, command, before, no_rotation;
  static NAME(solutions) solutions, solutions_before;
  static NAME(compensator) fresh_loop;
  NAME(rate_limits) limits;
  NAME(pose) frames[MDHCAL_MAX_JOINTS + 2];
  mdhcal_description description;
  mdhcal_joint joint;
  mdhcal_demands demands;
  size_t seen = 0;
  REAL q[8], kept[8], velocity[8], velocity_before[8], jacobian[8][6], jacobian_before[8][6];
  int i;

  /* Storage that was not initialised, or loaded wrongly, stays what it was. */
  memset(&fresh, 0, sizeof fresh);
  memset(&model, 0, sizeof model);
  CHECK(NAME(joint_count)(&model) == 0);
  CHECK(NAME(joint_count)(NULL) == 0);
  REFUSED(NAME(load)(&model, sizeof model, MDHCAL_ABI_VERSION + 1u, blob, size, NULL));
  REFUSED(NAME(load)(&model, sizeof model, MDHCAL_ABI_VERSION - 1u, blob, size, NULL));
  REFUSED(NAME(load)(&model, sizeof model - 1, MDHCAL_ABI_VERSION, blob, size, NULL));
  REFUSED(NAME(load)(&model, 0, MDHCAL_ABI_VERSION, blob, size, NULL));
  REFUSED(NAME(load)(NULL, sizeof model, MDHCAL_ABI_VERSION, blob, size, NULL));
  REFUSED(NAME(load)(&model, sizeof model, MDHCAL_ABI_VERSION, NULL, size, NULL));
  REFUSED(NAME(load)(crooked, sizeof model, MDHCAL_ABI_VERSION, blob, size, NULL));
  CHECK(NAME(load)(&model, sizeof model, MDHCAL_ABI_VERSION, blob, size - 1, NULL) == MDHCAL_BLOB_SIZE);
  CHECK(NAME(load)(&model, sizeof model, MDHCAL_ABI_VERSION, blob, 0, NULL) == MDHCAL_BLOB_SIZE);
  memset(&demands, 0, sizeof demands);
  demands.serial = "another";
  CHECK(NAME(load)(&model, sizeof model, MDHCAL_ABI_VERSION, blob, size, &demands) == MDHCAL_BLOB_SERIAL);
  memset(&demands, 0, sizeof demands);
  demands.verify = say_no;
  demands.verify_context = &seen;
  CHECK(NAME(load)(&model, sizeof model, MDHCAL_ABI_VERSION, blob, size, &demands) == MDHCAL_BLOB_UNSIGNED);
  memset(&demands, 0, sizeof demands);
  demands.minimum_counter = 0xFFFFFFFFu;
  CHECK(NAME(load)(&model, sizeof model, MDHCAL_ABI_VERSION, blob, size, &demands) == MDHCAL_BLOB_COUNTER);
  CHECK(untouched(&model, &fresh, sizeof model));
  memset(&demands, 0, sizeof demands);
  CHECK(NAME(load)(&model, sizeof model, MDHCAL_ABI_VERSION, blob, size, &demands) == MDHCAL_OK);
  CHECK(NAME(joint_count)(&model) == 6);
  memcpy(room.bytes + 4, &model, sizeof model);
  CHECK(NAME(joint_count)(crooked) == 0);

  /* Forward. */
  CHECK(NAME(forward)(&model, MDHCAL_NOMINAL, start, &nominal, NULL) == MDHCAL_OK);
  CHECK(NAME(forward)(&model, MDHCAL_CORRECTED, start, &corrected, jacobian) == MDHCAL_OK);
  CHECK(memcmp(&nominal, &corrected, sizeof nominal) != 0);
  memset(&before, 0x3B, sizeof before);
  memset(jacobian_before, 0x3B, sizeof jacobian_before);
  command = before;
  memcpy(jacobian, jacobian_before, sizeof jacobian);
  memcpy(q, start, sizeof q);
  q[3] = (REAL)2000;
  REFUSED(NAME(forward)(&model, MDHCAL_CORRECTED, q, &command, jacobian));
  REFUSED(NAME(forward)(&model, MDHCAL_CORRECTED, q, &command, NULL));
  REFUSED(NAME(forward)(&model, 2, start, &command, jacobian));
  REFUSED(NAME(forward)(&model, -1, start, &command, jacobian));
  REFUSED(NAME(forward)(&fresh, MDHCAL_CORRECTED, start, &command, jacobian));
  REFUSED(NAME(forward)(NULL, MDHCAL_CORRECTED, start, &command, jacobian));
  REFUSED(NAME(forward)(&model, MDHCAL_CORRECTED, NULL, &command, jacobian));
  REFUSED(NAME(forward)(&model, MDHCAL_CORRECTED, start, NULL, jacobian));
  CHECK(untouched(&command, &before, sizeof before) && untouched(jacobian, jacobian_before, sizeof jacobian));

  /* States. */
  memset(&blank, 0, sizeof blank);
  loop_a = blank;
  REFUSED(NAME(advance_ramp)(&loop_a));
  REFUSED(NAME(start_ramp)(&loop_a, &model, MDHCAL_CORRECTED, 100));
  REFUSED(NAME(start_at_rest)(&loop_a, sizeof loop_a + 1, &model, MDHCAL_CORRECTED));
  REFUSED(NAME(start_at_rest)(&loop_a, sizeof loop_a, &fresh, MDHCAL_CORRECTED));
  REFUSED(NAME(start_at_rest)(&loop_a, sizeof loop_a, NULL, MDHCAL_CORRECTED));
  REFUSED(NAME(start_at_rest)(NULL, sizeof loop_a, &model, MDHCAL_CORRECTED));
  REFUSED(NAME(start_at_rest)(crooked_state, sizeof loop_a, &model, MDHCAL_CORRECTED));
  REFUSED(NAME(start_at_rest)(&loop_a, sizeof loop_a, &model, 2));
  CHECK(untouched(&loop_a, &blank, sizeof blank));
  CHECK(NAME(start_at_rest)(&loop_a, sizeof loop_a, &model, MDHCAL_CORRECTED) == MDHCAL_OK);
  memset(&loop_b, 0, sizeof loop_b);
  CHECK(NAME(start_at_rest)(&loop_b, sizeof loop_b, &model, MDHCAL_NOMINAL) == MDHCAL_OK);
  blank = loop_b;
  REFUSED(NAME(start_ramp)(NULL, &model, MDHCAL_CORRECTED, 100));
  REFUSED(NAME(start_ramp)(&loop_b, &model, 2, 100));
  REFUSED(NAME(start_ramp)(&loop_b, &fresh, MDHCAL_CORRECTED, 100));
  REFUSED(NAME(start_ramp)(&loop_b, NULL, MDHCAL_CORRECTED, 100));
  REFUSED(NAME(advance_ramp)(NULL));
  REFUSED(NAME(start_frame_ramp)(&loop_b, NULL, &nominal, 100));
  REFUSED(NAME(start_frame_ramp)(&loop_b, &nominal, NULL, 100));
  REFUSED(NAME(start_frame_ramp)(&fresh_loop, &nominal, &nominal, 100));
  CHECK(untouched(&loop_b, &blank, sizeof blank));
  REFUSED(NAME(default_tick_options)(&model, (REAL)0.001, NULL));
  REFUSED(NAME(default_tick_options)(NULL, (REAL)0.001, &options));
  REFUSED(NAME(default_tick_options)(&fresh, (REAL)0.001, &options));
  REFUSED(NAME(default_tick_options)(&model, (REAL)0, &options));
  CHECK(NAME(default_tick_options)(&model, (REAL)0.001, &options) == MDHCAL_OK);
  CHECK(options.limits.max_step[0] < (REAL)0.0063 && options.limits.max_step[0] > (REAL)0.0062);
  for (i = 0; i < 8; ++i) options.limits.max_step[i] = (REAL)100; /* the following go there at once */
  CHECK(options.goal.task == MDHCAL_TASK_POSE && options.max_iterations > 0);

  /* The three forms. */
  memcpy(q, start, sizeof q);
  CHECK(NAME(pose_to_joints)(&loop_a, &options, &nominal, q, &report) == MDHCAL_OK);
  CHECK(report.position_error_m <= TOLERANCE && report.rotation_error_rad <= TOLERANCE && report.iterations > 0);
  memcpy(kept, q, sizeof kept);
  memcpy(q, start, sizeof q);
  CHECK(NAME(joints_to_joints)(&loop_a, &options, start, q, &report) == MDHCAL_OK);
  for (i = 0; i < 6; ++i) CHECK(q[i] - kept[i] < CLOSE && kept[i] - q[i] < CLOSE);
  CHECK(NAME(pose_to_pose)(&loop_a, &options, &nominal, q, &command, NULL) == MDHCAL_OK);
  CHECK(memcmp(&command, &nominal, sizeof command) != 0);
  memcpy(q, start, sizeof q);
  CHECK(NAME(pose_to_pose)(&loop_b, &options, &nominal, q, &command, &report) == MDHCAL_OK);
  for (i = 0; i < 3; ++i) {
    const REAL d = command.position_m[i] - nominal.position_m[i];
    CHECK(d < CLOSE && d > -CLOSE); /* on the nominal model the command is the pose */
  }
  CHECK(NAME(start_ramp)(&loop_b, &model, MDHCAL_CORRECTED, 100) == MDHCAL_OK);
  CHECK(NAME(ramp_ticks_left)(&loop_b) == 100 && NAME(ramp_ticks_left)(NULL) == 0);
  for (i = 0; i < 200; ++i) CHECK(NAME(advance_ramp)(&loop_b) == MDHCAL_OK);
  CHECK(NAME(ramp_ticks_left)(&loop_b) == 0);
  CHECK(NAME(pose_to_joints)(&loop_b, &options, &corrected, q, NULL) == MDHCAL_OK);
  for (i = 0; i < 6; ++i) CHECK(q[i] - start[i] < CLOSE && start[i] - q[i] < CLOSE);

  /* Misuse of them. */
  memcpy(q, start, sizeof q);
  memset(&report_before, 0x3B, sizeof report_before);
  report = report_before;
  command = before;
  memset(&blank, 0, sizeof blank);
  no_rotation = nominal;
  no_rotation.quaternion[0] += (REAL)1;
  wrong = options;
  wrong.goal.task = 4;
  REFUSED(NAME(pose_to_joints)(crooked_state, &options, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(NULL, &options, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&blank, &options, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&loop_a, NULL, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&loop_a, &wrong, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&loop_a, &options, NULL, q, &report));
  REFUSED(NAME(pose_to_joints)(&loop_a, &options, &no_rotation, q, &report));
  REFUSED(NAME(pose_to_joints)(&loop_a, &options, &nominal, NULL, &report));
  REFUSED(NAME(joints_to_joints)(NULL, &options, start, q, &report));
  REFUSED(NAME(joints_to_joints)(&blank, &options, start, q, &report));
  REFUSED(NAME(joints_to_joints)(&loop_a, NULL, start, q, &report));
  REFUSED(NAME(joints_to_joints)(&loop_a, &options, NULL, q, &report));
  REFUSED(NAME(joints_to_joints)(&loop_a, &options, start, NULL, &report));
  REFUSED(NAME(pose_to_pose)(NULL, &options, &nominal, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&blank, &options, &nominal, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&loop_a, NULL, &nominal, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&loop_a, &options, NULL, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&loop_a, &options, &no_rotation, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&loop_a, &options, &nominal, NULL, &command, &report));
  REFUSED(NAME(pose_to_pose)(&loop_a, &options, &nominal, q, NULL, &report));
  CHECK(untouched(q, start, sizeof q) && untouched(&command, &before, sizeof before) &&
        untouched(&report, &report_before, sizeof report));

  /* Velocities. */
  for (i = 0; i < 8; ++i) {
    limits.max_velocity[i] = 10;
    limits.max_acceleration[i] = 1000;
  }
  memset(velocity_before, 0x3B, sizeof velocity_before);
  memcpy(velocity, velocity_before, sizeof velocity);
  REFUSED(NAME(joint_velocities)(NULL, start, wanted, (REAL)0.001, &limits, velocity));
  REFUSED(NAME(joint_velocities)(&fresh_loop, start, wanted, (REAL)0.001, &limits, velocity));
  REFUSED(NAME(joint_velocities)(&loop_a, NULL, wanted, (REAL)0.001, &limits, velocity));
  REFUSED(NAME(joint_velocities)(&loop_a, start, NULL, (REAL)0.001, &limits, velocity));
  REFUSED(NAME(joint_velocities)(&loop_a, start, wanted, (REAL)0, &limits, velocity));
  REFUSED(NAME(joint_velocities)(&loop_a, start, wanted, (REAL)0.001, NULL, velocity));
  REFUSED(NAME(joint_velocities)(&loop_a, start, wanted, (REAL)0.001, &limits, NULL));
  REFUSED(NAME(joint_accelerations)(NULL, start, start, wanted, &limits, velocity));
  REFUSED(NAME(joint_accelerations)(&fresh, start, start, wanted, &limits, velocity));
  REFUSED(NAME(joint_accelerations)(&model, NULL, start, wanted, &limits, velocity));
  REFUSED(NAME(joint_accelerations)(&model, start, NULL, wanted, &limits, velocity));
  REFUSED(NAME(joint_accelerations)(&model, start, start, NULL, &limits, velocity));
  REFUSED(NAME(joint_accelerations)(&model, start, start, wanted, NULL, velocity));
  REFUSED(NAME(joint_accelerations)(&model, start, start, wanted, &limits, NULL));
  limits.max_velocity[2] = 0;
  REFUSED(NAME(joint_velocities)(&loop_a, start, wanted, (REAL)0.001, &limits, velocity));
  limits.max_velocity[2] = 10;
  CHECK(untouched(velocity, velocity_before, sizeof velocity));
  CHECK(NAME(joint_velocities)(&loop_a, start, wanted, (REAL)0.001, &limits, velocity) == MDHCAL_OK);
  CHECK(NAME(joint_accelerations)(&model, start, velocity, wanted, &limits, kept) == MDHCAL_OK);

  /* What the blob says. */
  REFUSED(NAME(describe)(&model, NULL));
  REFUSED(NAME(describe)(&fresh, &description));
  CHECK(NAME(describe)(&model, &description) == MDHCAL_OK);
  CHECK(description.name[63] == 0 && description.target_count >= 0 && description.tolerances.position_m > 0);
  REFUSED(NAME(describe_joint)(&model, 6, &joint));
  REFUSED(NAME(describe_joint)(&model, -1, &joint));
  REFUSED(NAME(describe_joint)(&model, 0, NULL));
  CHECK(NAME(describe_joint)(&model, 0, &joint) == MDHCAL_OK && joint.slides == 0);
  REFUSED(NAME(find_target)(&model, "no such target", &command));
  REFUSED(NAME(find_target)(&model, NULL, &command));
  for (i = 0; i < description.target_count; ++i) {
    CHECK(NAME(find_target)(&model, description.target[i].name, &command) == MDHCAL_OK);
    CHECK(command.position_m[0] - (REAL)description.target[i].flange_p_m[0] < CLOSE);
  }
  REFUSED(NAME(link_frames)(&model, 2, start, frames));
  REFUSED(NAME(link_frames)(&model, MDHCAL_CORRECTED, start, NULL));
  CHECK(NAME(link_frames)(&model, MDHCAL_CORRECTED, start, frames) == MDHCAL_OK);
  for (i = 0; i < 3; ++i) CHECK(frames[7].position_m[i] - corrected.position_m[i] < CLOSE);

  /* Poses and frames: a tool and a user frame, and the pose of that tool in that frame. */
  REFUSED(NAME(invert)(&no_rotation, &command));
  REFUSED(NAME(invert)(NULL, &command));
  REFUSED(NAME(multiply)(&no_rotation, &nominal, &command));
  CHECK(NAME(invert)(&corrected, &command) == MDHCAL_OK);
  CHECK(NAME(multiply)(&corrected, &command, &command) == MDHCAL_OK);
  for (i = 0; i < 3; ++i) CHECK(command.position_m[i] < CLOSE && command.position_m[i] > -CLOSE);
  memcpy(q, start, sizeof q);
  CHECK(NAME(start_frame_ramp)(&loop_a, &nominal, &frames[1], 10) == MDHCAL_OK);
  for (i = 0; i < 10; ++i) CHECK(NAME(advance_ramp)(&loop_a) == MDHCAL_OK);
  CHECK(NAME(invert)(&nominal, &command) == MDHCAL_OK);
  CHECK(NAME(multiply)(&command, &corrected, &command) == MDHCAL_OK);
  CHECK(NAME(multiply)(&command, &frames[1], &command) == MDHCAL_OK);
  options.goal.position_tolerance_m *= 4; /* rounding of five products */
  options.goal.rotation_tolerance_rad *= 4;
  CHECK(NAME(pose_to_joints)(&loop_a, &options, &command, q, &report) == MDHCAL_OK);
  for (i = 0; i < 6; ++i) CHECK(q[i] - start[i] < CLOSE && start[i] - q[i] < CLOSE);
  CHECK(mdhcal_usable(MDHCAL_STEP_LIMITED) == 1 && mdhcal_usable(MDHCAL_BAD_INPUT) == 0 && mdhcal_usable(99) == 0);
  CHECK(mdhcal_check_environment() == MDHCAL_OK);

  /* Solutions. */
  memset(&solutions_before, 0x3B, sizeof solutions_before);
  solutions = solutions_before;
  memcpy(q, start, sizeof q);
  REFUSED(NAME(find_solutions)(NULL, &options.goal, 0, &corrected, start, &solutions));
  REFUSED(NAME(find_solutions)(&model, NULL, 0, &corrected, start, &solutions));
  REFUSED(NAME(find_solutions)(&model, &wrong.goal, 0, &corrected, start, &solutions));
  REFUSED(NAME(find_solutions)(&model, &options.goal, -1, &corrected, start, &solutions));
  REFUSED(NAME(find_solutions)(&model, &options.goal, 401, &corrected, start, &solutions));
  REFUSED(NAME(find_solutions)(&model, &options.goal, 0, NULL, start, &solutions));
  REFUSED(NAME(find_solutions)(&model, &options.goal, 0, &no_rotation, start, &solutions));
  REFUSED(NAME(find_solutions)(&model, &options.goal, 0, &corrected, NULL, &solutions));
  REFUSED(NAME(find_solutions)(&model, &options.goal, 0, &corrected, start, NULL));
  REFUSED(NAME(cold_start)(NULL, &options.goal, 0, &corrected, q));
  REFUSED(NAME(cold_start)(&model, NULL, 0, &corrected, q));
  REFUSED(NAME(cold_start)(&model, &options.goal, 401, &corrected, q));
  REFUSED(NAME(cold_start)(&model, &options.goal, 0, NULL, q));
  REFUSED(NAME(cold_start)(&model, &options.goal, 0, &no_rotation, q));
  REFUSED(NAME(cold_start)(&model, &options.goal, 0, &corrected, NULL));
  CHECK(untouched(&solutions, &solutions_before, sizeof solutions) && untouched(q, start, sizeof q));
  CHECK(NAME(find_solutions)(&model, &options.goal, 0, &corrected, start, &solutions) == MDHCAL_OK);
  CHECK(solutions.count >= 2 && solutions.distance[0] < CLOSE);
  for (i = 0; i < 6; ++i) q[i] += (REAL)0.7;
  CHECK(NAME(cold_start)(&model, &options.goal, 0, &corrected, q) == MDHCAL_OK);
  CHECK(NAME(forward)(&model, MDHCAL_CORRECTED, q, &command, NULL) == MDHCAL_OK);
  for (i = 0; i < 3; ++i) {
    const REAL d = command.position_m[i] - corrected.position_m[i];
    CHECK(d <= TOLERANCE && d >= -TOLERANCE);
  }
  no_rotation = corrected;
  no_rotation.position_m[0] = 3; /* out of reach */
  memcpy(kept, q, sizeof kept);
  CHECK(NAME(cold_start)(&model, &options.goal, 0, &no_rotation, q) == MDHCAL_OUT_OF_REACH);
  CHECK(untouched(q, kept, sizeof q));

  /* Words. */
  CHECK(strcmp(mdhcal_status_text(MDHCAL_OK), "ok") == 0);
  CHECK(mdhcal_status_text(MDHCAL_SELF_TEST_TOLERANCE) != NULL && mdhcal_status_text(-7) != NULL && mdhcal_status_text(1000000) != NULL);
  return 0;
}
