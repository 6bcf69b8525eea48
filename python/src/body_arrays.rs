//! The arrays that one world and many have: those of many have an axis of worlds before the others.

/// Makes the properties of a class that has `worlds()` and `layout()`. Shapes are those of one
/// world.
macro_rules! body_arrays {
    ($class:ty) => {
        #[pymethods]
        impl $class {
            /// Names of the bodies, in the order of the rows of arrays.
            #[getter]
            fn body_names(&self) -> Vec<String> {
                self.layout().names.clone()
            }

            /// Names of the joints, in the order of the rows of their arrays.
            #[getter]
            fn joint_names(&self) -> Vec<String> {
                self.layout().joint_names.clone()
            }

            /// Names of the drives, `JOINT.drives.INDEX`.
            #[getter]
            fn drive_names(&self) -> Vec<String> {
                self.layout().drive_names()
            }

            /// Masses (bodies,) [kg]; infinite where no force moves the body.
            #[getter]
            fn masses<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_property(py, Property::Masses)
            }

            /// Principal moments of inertia about the centres of mass (bodies, 3) [kg m^2];
            /// infinite where no force moves the body, 0 for a point mass.
            #[getter]
            fn inertias<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_property(py, Property::Inertias)
            }

            /// Principal axes (bodies, 4): quaternions x, y, z, w from the principal frame to the
            /// body's.
            #[getter]
            fn principal_axes<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_property(py, Property::PrincipalAxes)
            }

            /// Which bodies sleep (bodies,); none does unless the settings have `sleep`.
            #[getter]
            fn asleep<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_asleep(py)
            }

            /// Centres of mass (bodies, 3) [m].
            #[getter]
            fn positions<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_state(py, Quantity::Positions, None)
            }

            #[setter]
            fn set_positions(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
                self.worlds().set_state(None, &[(Quantity::Positions, Some(value))])
            }

            /// Quaternions x, y, z, w (bodies, 4), from body coordinates to world coordinates.
            #[getter]
            fn orientations<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_state(py, Quantity::Orientations, None)
            }

            #[setter]
            fn set_orientations(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
                self.worlds().set_state(None, &[(Quantity::Orientations, Some(value))])
            }

            /// Velocities of the centres of mass (bodies, 3) [m/s].
            #[getter]
            fn linear_velocities<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_state(py, Quantity::LinearVelocities, None)
            }

            #[setter]
            fn set_linear_velocities(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
                self.worlds().set_state(None, &[(Quantity::LinearVelocities, Some(value))])
            }

            /// Angular velocities (bodies, 3) [rad/s], world frame.
            #[getter]
            fn angular_velocities<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_state(py, Quantity::AngularVelocities, None)
            }

            #[setter]
            fn set_angular_velocities(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
                self.worlds().set_state(None, &[(Quantity::AngularVelocities, Some(value))])
            }

            /// Position, orientation, velocity and angular velocity of each body (bodies, 13). To
            /// set what was read changes bits, for the state is momentum: a snapshot goes back
            /// exactly.
            #[getter]
            fn states<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_state(py, Quantity::States, None)
            }

            #[setter]
            fn set_states(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
                self.worlds().set_state(None, &[(Quantity::States, Some(value))])
            }

            /// Writes `states` into an array that is there, and returns it: nothing is allocated.
            fn read_states<'py>(&mut self, py: Python<'py>, out: Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_state(py, Quantity::States, Some(out))
            }

            /// Where the second body of each joint stands against the first (joints, 6):
            /// translation [m], then rotation vector [rad], along the axes of the joint, as of the
            /// last step.
            #[getter]
            fn joint_values<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_joints(py, JointQuantity::Values)
            }

            /// How fast it moves there (joints, 6) [m/s] [rad/s], as of the last step.
            #[getter]
            fn joint_speeds<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_joints(py, JointQuantity::Speeds)
            }

            /// Forces of the joints on their second bodies (joints, 3) [N], world frame, in the
            /// last step.
            #[getter]
            fn joint_forces<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_joints(py, JointQuantity::Forces)
            }

            /// Torques of the joints on their second bodies (joints, 3) [N m], world frame, in the
            /// last step.
            #[getter]
            fn joint_torques<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_joints(py, JointQuantity::Torques)
            }

            /// Where the drives of the joints go (drives,) [m] [rad]; nan where only a velocity is
            /// kept.
            #[getter]
            fn drive_positions<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_drives(py, DriveQuantity::Positions)
            }

            /// How fast the drives are to go (drives,) [m/s] [rad/s].
            #[getter]
            fn drive_velocities<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_drives(py, DriveQuantity::Velocities)
            }

            /// Greatest forces [N] or torques [N m] of the drives (drives,); infinite where there
            /// is none.
            #[getter]
            fn drive_max_forces<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.worlds().read_drives(py, DriveQuantity::MaxForces)
            }
        }
    };
}

pub(crate) use body_arrays;
