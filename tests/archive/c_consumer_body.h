/* SPDX-License-Identifier: MIT */
/* Included by c_consumer.c only, once a precision; hence no guard. */
int CONSUMER(const uint8_t* blob, size_t size) {
  static const REAL start[8] = {(REAL)0.3, (REAL)-1.2, (REAL)1.5, (REAL)0.4, (REAL)1.1, (REAL)-0.6, 0, 0};
  static const REAL wanted[6] = {(REAL)0.01, 0, 0, 0, 0, 0};
  static NAME(model) model, fresh;
  static union {
    double align;
    unsigned char bytes[MDHCAL_MODEL_SIZE + 8];
  } room;
  NAME(model)* const crooked = (NAME(model)*)(void*)(room.bytes + 4);
  NAME(state) loop_a, loop_b, blank;
  NAME(state)* const crooked_state = (NAME(state)*)(void*)(room.bytes + 4);
  NAME(tick_options) options, wrong;
  NAME(tick_report) report, report_before;
  NAME(pose) nominal, corrected, command, before, no_rotation;
  static NAME(solutions) solutions, solutions_before;
  mdhcal_demands demands;
  size_t seen = 0;
  REAL q[8], kept[8], velocity[8], velocity_before[8], limit[8], jacobian[8][6], jacobian_before[8][6];
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
  REFUSED(NAME(advance)(&loop_a, (REAL)0.001));
  REFUSED(NAME(start_ramp)(&loop_a, MDHCAL_CORRECTED, (REAL)0.1));
  REFUSED(NAME(start)(&loop_a, sizeof loop_a + 1, &model, MDHCAL_CORRECTED));
  REFUSED(NAME(start)(&loop_a, sizeof loop_a, &fresh, MDHCAL_CORRECTED));
  REFUSED(NAME(start)(&loop_a, sizeof loop_a, NULL, MDHCAL_CORRECTED));
  REFUSED(NAME(start)(NULL, sizeof loop_a, &model, MDHCAL_CORRECTED));
  REFUSED(NAME(start)(crooked_state, sizeof loop_a, &model, MDHCAL_CORRECTED));
  REFUSED(NAME(start)(&loop_a, sizeof loop_a, &model, 2));
  CHECK(untouched(&loop_a, &blank, sizeof blank));
  CHECK(NAME(start)(&loop_a, sizeof loop_a, &model, MDHCAL_CORRECTED) == MDHCAL_OK);
  memset(&loop_b, 0, sizeof loop_b);
  CHECK(NAME(start)(&loop_b, sizeof loop_b, &model, MDHCAL_NOMINAL) == MDHCAL_OK);
  blank = loop_b;
  REFUSED(NAME(start_ramp)(NULL, MDHCAL_CORRECTED, (REAL)0.1));
  REFUSED(NAME(start_ramp)(&loop_b, 2, (REAL)0.1));
  REFUSED(NAME(start_ramp)(&loop_b, MDHCAL_CORRECTED, (REAL)-0.1));
  REFUSED(NAME(start_ramp)(&loop_b, MDHCAL_CORRECTED, (REAL)1e7));
  REFUSED(NAME(advance)(NULL, (REAL)0.001));
  REFUSED(NAME(advance)(&loop_b, (REAL)-1));
  CHECK(untouched(&loop_b, &blank, sizeof blank));
  REFUSED(NAME(default_tick_options)(&model, NULL));
  REFUSED(NAME(default_tick_options)(NULL, &options));
  REFUSED(NAME(default_tick_options)(&fresh, &options));
  CHECK(NAME(default_tick_options)(&model, &options) == MDHCAL_OK);
  CHECK(options.goal.task == MDHCAL_TASK_POSE && options.max_iterations > 0);

  /* The three forms. */
  memcpy(q, start, sizeof q);
  CHECK(NAME(pose_to_joints)(&model, &loop_a, &options, &nominal, q, &report) == MDHCAL_OK);
  CHECK(report.position_error_m <= TOLERANCE && report.rotation_error_rad <= TOLERANCE && report.iterations > 0);
  memcpy(kept, q, sizeof kept);
  memcpy(q, start, sizeof q);
  CHECK(NAME(joints_to_joints)(&model, &loop_a, &options, start, q, &report) == MDHCAL_OK);
  for (i = 0; i < 6; ++i) CHECK(q[i] - kept[i] < CLOSE && kept[i] - q[i] < CLOSE);
  CHECK(NAME(pose_to_pose)(&model, &loop_a, &options, &nominal, q, &command, NULL) == MDHCAL_OK);
  CHECK(memcmp(&command, &nominal, sizeof command) != 0);
  memcpy(q, start, sizeof q);
  CHECK(NAME(pose_to_pose)(&model, &loop_b, &options, &nominal, q, &command, &report) == MDHCAL_OK);
  for (i = 0; i < 3; ++i) {
    const REAL d = command.position_m[i] - nominal.position_m[i];
    CHECK(d < CLOSE && d > -CLOSE); /* on the nominal model the command is the pose */
  }
  CHECK(NAME(start_ramp)(&loop_b, MDHCAL_CORRECTED, (REAL)0.1) == MDHCAL_OK);
  for (i = 0; i < 200; ++i) CHECK(NAME(advance)(&loop_b, (REAL)0.001) == MDHCAL_OK);
  CHECK(NAME(pose_to_joints)(&model, &loop_b, &options, &corrected, q, NULL) == MDHCAL_OK);
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
  REFUSED(NAME(pose_to_joints)(NULL, &loop_a, &options, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&fresh, &loop_a, &options, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(crooked, &loop_a, &options, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&model, NULL, &options, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&model, &blank, &options, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&model, &loop_a, NULL, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&model, &loop_a, &wrong, &nominal, q, &report));
  REFUSED(NAME(pose_to_joints)(&model, &loop_a, &options, NULL, q, &report));
  REFUSED(NAME(pose_to_joints)(&model, &loop_a, &options, &no_rotation, q, &report));
  REFUSED(NAME(pose_to_joints)(&model, &loop_a, &options, &nominal, NULL, &report));
  REFUSED(NAME(joints_to_joints)(NULL, &loop_a, &options, start, q, &report));
  REFUSED(NAME(joints_to_joints)(&model, &blank, &options, start, q, &report));
  REFUSED(NAME(joints_to_joints)(&model, &loop_a, NULL, start, q, &report));
  REFUSED(NAME(joints_to_joints)(&model, &loop_a, &options, NULL, q, &report));
  REFUSED(NAME(joints_to_joints)(&model, &loop_a, &options, start, NULL, &report));
  REFUSED(NAME(pose_to_pose)(NULL, &loop_a, &options, &nominal, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&model, &blank, &options, &nominal, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&model, &loop_a, NULL, &nominal, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&model, &loop_a, &options, NULL, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&model, &loop_a, &options, &no_rotation, q, &command, &report));
  REFUSED(NAME(pose_to_pose)(&model, &loop_a, &options, &nominal, NULL, &command, &report));
  REFUSED(NAME(pose_to_pose)(&model, &loop_a, &options, &nominal, q, NULL, &report));
  CHECK(untouched(q, start, sizeof q) && untouched(&command, &before, sizeof before) &&
        untouched(&report, &report_before, sizeof report));

  /* Velocities. */
  for (i = 0; i < 8; ++i) limit[i] = 10;
  memset(velocity_before, 0x3B, sizeof velocity_before);
  memcpy(velocity, velocity_before, sizeof velocity);
  REFUSED(NAME(joint_velocities)(NULL, start, wanted, limit, velocity));
  REFUSED(NAME(joint_velocities)(&fresh, start, wanted, limit, velocity));
  REFUSED(NAME(joint_velocities)(&model, NULL, wanted, limit, velocity));
  REFUSED(NAME(joint_velocities)(&model, start, NULL, limit, velocity));
  REFUSED(NAME(joint_velocities)(&model, start, wanted, NULL, velocity));
  REFUSED(NAME(joint_velocities)(&model, start, wanted, limit, NULL));
  limit[2] = 0;
  REFUSED(NAME(joint_velocities)(&model, start, wanted, limit, velocity));
  limit[2] = 10;
  CHECK(untouched(velocity, velocity_before, sizeof velocity));
  CHECK(NAME(joint_velocities)(&model, start, wanted, limit, velocity) == MDHCAL_OK);

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
